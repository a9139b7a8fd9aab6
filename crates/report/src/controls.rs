//! The view with its controls: what lies over the canvas, the slider, the choices of what is shown.

use maud::{Markup, PreEscaped, html};
use pneuflex_model::Clock;

use crate::regions::Regions;
use crate::report::Report;

const PLAY: &str = r#"<svg viewBox="0 0 24 24" aria-hidden="true"><path class="play" d="M8 5.5v13l11-6.5z"/><path class="pause" d="M7 5h3.5v14H7zM13.5 5H17v14h-3.5z"/></svg>"#;

/// The canvas with what lies over it; `has_values` says whether a click reads some.
pub(crate) fn stage(noun: &str, has_values: bool) -> Markup {
    let view = |name: &str, label: &str, key: &str| {
        html! { button type="button" data-view=(name) title={ "View: " (name) " (" (key) ")" } { (label) } }
    };
    html! {
        div .view {
            div #stage .stage {
                canvas #canvas tabindex="0" role="img" aria-label={ "The deformed " (noun) " in three dimensions" } aria-describedby="hint" {}
                img #printout alt={ "The deformed " (noun) };
                div #legend .legend aria-live="polite" {}
                @if has_values { div #axes .axes {} }
                div .views role="group" aria-label="Views" {
                    (view("iso", "Iso", "1")) (view("side", "Side", "2")) (view("front", "Front", "3")) (view("reset", "Reset", "0"))
                    button #snapshot type="button" title="Save the view as a picture (PNG)" { "PNG" }
                    @if has_values {
                        button #record type="button" hidden title="Play once from rest and save it as a film (WebM)" { "Film" }
                        button #photo type="button" title="Lay the side view over a photo" { "Photo" }
                    }
                }
                p #hint .hint {
                    span .pointer { "Drag to turn, right button to shift, wheel to zoom" @if has_values { ", click to read values" } "." }
                    span .touch { "Drag to turn, two fingers to shift and zoom" @if has_values { ", tap to read values" } "." }
                    span .hidden { " Keys: arrows turn, plus and minus zoom, 1, 2, 3 and 0 choose a view, space plays." }
                }
                p #no-view .notice hidden {
                    "This browser shows no three-dimensional graphics (WebGL). Plots and tables below are complete."
                }
            }
            @if has_values { (photo_bar()) }
            div #probe .probe role="status" hidden {}
        }
    }
}

/// What there is to do with a photo behind the side view.
fn photo_bar() -> Markup {
    html! {
        div #photo-bar .photo-bar hidden {
            input #photo-file type="file" accept="image/*" hidden;
            output #photo-step role="status" {}
            label { "photo " input #see-through type="range" min="0" max="1" step="any" value="0.5" aria-label="How far the photo shines through the body"; }
            button #photo-align type="button" { "Align" }
            button #photo-remove type="button" { "Remove" }
        }
    }
}

pub(crate) fn transport(report: &Report<'_>) -> Markup {
    let label = match report.problem.clock {
        Clock::Pressure => "Air pressure in kPa",
        Clock::Steps => "Time",
    };
    slider(label)
}

/// Play button, slider and readout.
pub(crate) fn slider(label: &str) -> Markup {
    html! {
        div .transport {
            button #play .icon type="button" aria-label="Play" title="Play (space)" { (PreEscaped(PLAY)) }
            div .track {
                label .hidden for="time" { (label) }
                input #time type="range" min="0" step="any";
                div #ticks .ticks {}
            }
            div .readout {
                output #time-readout for="time" {}
                span #origin .origin {}
                span #key-numbers .key-numbers {}
            }
        }
    }
}

/// Fields that are chosen from a list.
const MORE_FIELDS: [(&str, &str); 12] = [
    ("ux", "displacement along x"),
    ("uy", "displacement along y"),
    ("uz", "displacement along z"),
    ("stretch", "largest stretch"),
    ("thickness", "thickness change"),
    ("pressure", "pressure in the solid"),
    ("sxx", "stress xx"),
    ("syy", "stress yy"),
    ("szz", "stress zz"),
    ("sxy", "stress xy"),
    ("syz", "stress yz"),
    ("sxz", "stress xz"),
];

/// A choice of one.
fn radio(name: &str, value: &str, label: &str, checked: bool) -> Markup {
    html! { label { input type="radio" name=(name) value=(value) checked[checked]; span { (label) } } }
}

/// Something that is shown or not.
fn tick(id: &str, label: &str, checked: bool) -> Markup {
    html! { label .tick { input id=(id) type="checkbox" checked[checked]; span { (label) } } }
}

pub(crate) fn options(report: &Report<'_>) -> Markup {
    let regions = Regions::of(report.problem);
    html! {
        div #options .options {
            (colours(report, &regions))
            fieldset {
                legend { "Section" }
                div .segments {
                    (radio("section", "off", "Off", true))
                    (radio("section", "x", "x", false)) (radio("section", "y", "y", false)) (radio("section", "z", "z", false))
                }
                div .cut {
                    label .hidden for="cut" { "Position of the section in mm, in the undeformed body" }
                    input #cut type="range" step="any" disabled;
                    output #cut-readout for="cut" { "–" }
                    button #flip type="button" disabled title="Show the other side" { "Flip" }
                }
            }
            (parts(report, &regions))
        }
    }
}

/// Which field is shown in colour, and the range of the colours.
fn colours(report: &Report<'_>, regions: &Regions) -> Markup {
    html! {
        fieldset {
            legend { "Colour" }
            div .segments {
                (radio("field", "vonMises", "von Mises", true))
                (radio("field", "displacement", "Displacement", false))
                @if report.may_touch() { (radio("field", "contactPressure", "Contact", false)) }
            }
            label .more {
                span .hidden { "Further fields" }
                select #more-fields {
                    option value="" selected { "more …" }
                    @for (value, name) in MORE_FIELDS { option value=(value) { (name) } }
                }
            }
            (tick("fit", &format!("fit range to this {}", report.parameter()), false))
            @if regions.are_many() { (tick("own-ranges", "a range for each material", false)) }
            span .range {
                @if regions.are_many() {
                    label #range-of-label hidden {
                        span .hidden { "Material whose range is set by hand" }
                        select #range-of { @for (number, name) in regions.names.iter().enumerate() { option value=(number) { (name) } } }
                    }
                }
                label for="low" { "from" } input #low type="number" step="any" placeholder="auto" aria-label="Least value of the colours";
                label for="high" { "to" } input #high type="number" step="any" placeholder="auto" aria-label="Greatest value of the colours";
            }
        }
    }
}

/// What is shown of the body and around it.
fn parts(report: &Report<'_>, regions: &Regions) -> Markup {
    let whole = match report.problem.symmetry.len() {
        1 => "both halves",
        _ => "whole body",
    };
    let part = |kind: &str, number: usize, name: &str| {
        html! {
            label .tick {
                input type="checkbox" checked data-region=[(kind == "region").then_some(number)] data-obstacle=[(kind == "obstacle").then_some(number)];
                span { (name) }
            }
        }
    };
    html! {
        fieldset {
            legend { "Show" }
            @if !report.problem.symmetry.is_empty() { (tick("whole", whole, true)) }
            @if regions.are_many() {
                @for (number, name) in regions.names.iter().enumerate() { (part("region", number, name)) }
            }
            @for (number, obstacle) in report.problem.obstacles.iter().enumerate() { (part("obstacle", number, &obstacle.name)) }
            (tick("ghost", "rest shape", true))
            (tick("mesh", "mesh", false))
        }
    }
}
