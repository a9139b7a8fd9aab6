//! From results to inputs, and from the tolerances of inputs to those of results: which constants and lengths give what was measured, which design gives what is wanted.
//!
//! Both are searches for a few numbers of a case or model file, its variables. One solution of a design gives the results at all
//! pressures with their exact derivatives by the variables ([`pneuflex::gradient`]), and a quadratic programme the next design.
//!
//! | module | what is there |
//! |---|---|
//! | [`variables`] | the numbers that are looked for, and their bounds |
//! | [`designs`] | solving a design: results and derivatives; which one it starts from |
//! | [`history`] | what was solved, in the folder of a search, from which it goes on |
//! | [`minimise`], [`quadratic`] | Gauss-Newton steps and SQP in a trust region; the programme of a step |
//! | [`search`], [`starts`] | a search from its file to its folder; where it begins |
//! | [`measurements`], [`identify`] | constants and lengths from measurements, with their confidence intervals |
//! | [`curve`], [`design`], `design_file`, `design_page` | designs from targets, extremes and limits; the page of such a search |
//! | [`uncertainty`] | how far results spread by the tolerances of inputs |

pub mod curve;
pub mod design;
mod design_file;
mod design_page;
pub mod designs;
pub mod history;
pub mod identify;
pub mod measurements;
pub mod minimise;
pub mod quadratic;
pub mod search;
pub mod starts;
pub mod uncertainty;
pub mod variables;
