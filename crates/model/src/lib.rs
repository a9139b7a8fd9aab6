//! The problem as plain data: case file, material, loads, contact, supports.
