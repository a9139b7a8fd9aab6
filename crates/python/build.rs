//! Says to the linker of macOS that what Python offers is found when Python loads the module.

fn main() {
    pyo3_build_config::add_extension_module_link_args();
}
