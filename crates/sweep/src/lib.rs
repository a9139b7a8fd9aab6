//! Many designs of one case, model or deck: which ones, each solved once whatever dies, and the table of what became of them.
//!
//! A sweep's folder holds
//!
//! * `sweep.json`: the designs, and what they have in common ([`plan`]);
//! * `rows/IDENTITY.json`: what became of a design, one file for each that is finished ([`row`]);
//! * `designs/IDENTITY/`: its result folder, if fields are kept;
//! * `neighbours/IDENTITY.bin`: the equilibria of a design that others start from, until all are finished;
//! * `table.csv`: a row for every state of every design, made from the others ([`table`]).
//!
//! A design's identity ([`identity`]) is what its results are a function of, so that whoever goes on with a folder, this program or the Python
//! package, solves what is not there and nothing else.
//!
//! | module | what is there |
//! |---|---|
//! | [`sweep_file`], [`node`], [`space`] | which designs: the file that says so, values by keys in it, grids, lists, samples |
//! | [`base`], [`identity`], [`plan`] | a design as something to be solved, its name, all of them |
//! | [`design`], [`row`] | solving one, what became of it |
//! | [`neighbours`] | which designs start from similar ones |
//! | [`folder`], [`table`] | the folder of a sweep and its table |
//! | [`workers`] | processes that solve designs |
//! | [`job_script`] | scripts for clusters |

pub mod base;
pub mod design;
pub mod folder;
pub mod identity;
pub mod job_script;
pub mod neighbours;
pub mod node;
pub mod plan;
pub mod row;
pub mod space;
pub mod sweep_file;
pub mod table;
pub mod workers;

pub use base::Base;
pub use folder::Folder;
pub use plan::Plan;
pub use row::Row;
pub use sweep_file::SweepFile;
