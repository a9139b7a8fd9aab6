//! The model file: a body from a mesh file, a deck or the actuator's parameters, with materials, supports and loads by named sets.

mod build;
mod hollows;
mod ranges;
mod tables;

pub use build::Study;
pub use tables::{
    CavityTable, ContactTable, EquationTable, ForceTable, GravityTable, Inlets, Model, PressureTable, RegionTable,
    Source, Steps, SupportTable, Times, TractionTable,
};

pub use crate::series::Series;
