//! The files of `assets`, which become part of the page.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Map, Value};

/// The modules by the names under which they import each other.
const MODULES: [(&str, &str); 27] = [
    ("three", include_str!("../assets/vendor/three.module.min.js")),
    ("three/orbit-controls", include_str!("../assets/vendor/OrbitControls.js")),
    ("pneuflex/main", include_str!("../assets/js/main.js")),
    ("pneuflex/data", include_str!("../assets/js/data.js")),
    ("pneuflex/interpolation", include_str!("../assets/js/interpolation.js")),
    ("pneuflex/format", include_str!("../assets/js/format.js")),
    ("pneuflex/colours", include_str!("../assets/js/colours.js")),
    ("pneuflex/legend", include_str!("../assets/js/legend.js")),
    ("pneuflex/material", include_str!("../assets/js/material.js")),
    ("pneuflex/states", include_str!("../assets/js/states.js")),
    ("pneuflex/section", include_str!("../assets/js/section.js")),
    ("pneuflex/runs", include_str!("../assets/js/runs.js")),
    ("pneuflex/images", include_str!("../assets/js/images.js")),
    ("pneuflex/body", include_str!("../assets/js/body.js")),
    ("pneuflex/obstacles", include_str!("../assets/js/obstacles.js")),
    ("pneuflex/stage", include_str!("../assets/js/stage.js")),
    ("pneuflex/viewer", include_str!("../assets/js/viewer.js")),
    ("pneuflex/photo", include_str!("../assets/js/photo.js")),
    ("pneuflex/probe", include_str!("../assets/js/probe.js")),
    ("pneuflex/transport", include_str!("../assets/js/transport.js")),
    ("pneuflex/plots", include_str!("../assets/js/plots.js")),
    ("pneuflex/own-plot", include_str!("../assets/js/own_plot.js")),
    ("pneuflex/plot-layout", include_str!("../assets/js/plot_layout.js")),
    ("pneuflex/setup", include_str!("../assets/js/setup.js")),
    ("pneuflex/axes", include_str!("../assets/js/axes.js")),
    ("pneuflex/record", include_str!("../assets/js/record.js")),
    ("pneuflex/snapshot", include_str!("../assets/js/snapshot.js")),
];

/// Licence of what is not our own.
pub const LICENCES: &str = include_str!("../assets/vendor/three-LICENSE.txt");

/// The style sheet.
pub const STYLE: &str = concat!(
    include_str!("../assets/css/theme.css"),
    include_str!("../assets/css/layout.css"),
    include_str!("../assets/css/viewer.css"),
    include_str!("../assets/css/tables.css"),
    include_str!("../assets/css/print.css"),
);

/// An import map with every module as a `data:` address: a page opened from disk may not load modules from files beside it.
pub fn import_map() -> String {
    let address = |text: &str| format!("data:text/javascript;base64,{}", STANDARD.encode(text));
    let imports: Map<String, Value> =
        MODULES.iter().map(|(name, text)| ((*name).into(), address(text).into())).collect();
    serde_json::json!({ "imports": imports }).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_module_that_is_imported_is_there() {
        for (name, text) in MODULES {
            for line in text.lines().filter(|_| name.starts_with("pneuflex/")) {
                let Some(imported) = line.split(" from \"").nth(1).and_then(|rest| rest.split('"').next()) else {
                    continue;
                };
                assert!(MODULES.iter().any(|(other, _)| *other == imported), "{name} imports {imported}");
            }
        }
    }

    #[test]
    fn nothing_is_asked_of_the_network() {
        for (name, text) in MODULES.iter().filter(|(name, _)| name.starts_with("pneuflex/")) {
            // The name space of SVG is an address only in form.
            let addresses = text.replace("http://www.w3.org/2000/svg", "");
            assert!(!addresses.contains("http") && !addresses.contains("fetch("), "{name}");
        }
        assert!(!STYLE.contains("url(") && !STYLE.contains("@import"));
        let map = import_map();
        assert!(!map.contains('<') && !map.contains("http"));
    }
}
