//! What changes a result most: its derivatives, as a table.

use maud::{Markup, html};

use crate::numbers::{difference, number};
use crate::report::Report;
use crate::summary::{Derivative, Gradient, NoDerivative};

/// The tables of all results whose derivatives were asked for.
pub fn sensitivity(report: &Report<'_>) -> Markup {
    html! { @for gradient in &report.summary.gradients { (table(report, gradient)) } }
}

fn table(report: &Report<'_>, gradient: &Gradient) -> Markup {
    let at = report.words(gradient.time.unwrap_or(gradient.pressure_kpa));
    html! {
        section .sheet {
            h2 { "What changes " code { (gradient.of) } " most" }
            p { "It is " (number(gradient.value)) " at " (at) "." }
            div .scroll tabindex="0" role="region" aria-label={ "Derivatives of " (gradient.of) } {
                table .results {
                    thead {
                        tr {
                            th scope="col" { "number" }
                            th scope="col" { "value" }
                            th scope="col" { "change per unit" }
                            th scope="col" { "change per percent" }
                        }
                    }
                    tbody {
                        @for Derivative { by, value, unit, derivative, per_percent } in &gradient.derivatives {
                            tr {
                                th scope="row" { code { (by) } }
                                td { (number(*value)) @if !unit.is_empty() { " " span .unit { (unit) } } }
                                td { (difference(*derivative)) @if !unit.is_empty() { " " span .unit { "per " (unit) } } }
                                td { (difference(*per_percent)) }
                            }
                        }
                    }
                }
            }
            @if !gradient.without.is_empty() {
                p .note {
                    "There is no derivative by "
                    @for (i, NoDerivative { by, why }) in gradient.without.iter().enumerate() {
                        @if i > 0 { "; " } code { (by) } ": " (why)
                    }
                    "."
                }
            }
            p .note {
                "Derivatives are exact for the equilibrium on this mesh, whose elements follow the lengths. They hold for small changes: where \
                 more walls come to touch, they change."
            }
        }
    }
}
