//! `cargo xtask coverage`: how often 95 % intervals of fits cover the true constants.

use std::process::ExitCode;

use pneuflex_verification::intervals::coverage;

/// Shares of 95 % intervals that their linearisation is good enough for.
const BOUNDS: [f64; 2] = [0.9, 0.99];

pub fn run(arguments: &[String]) -> ExitCode {
    let draws = match arguments {
        [] => Some(400),
        [option, number] if option == "--draws" => number.parse().ok().filter(|draws| *draws > 0),
        _ => None,
    };
    let Some(draws) = draws else {
        eprintln!("coverage: expected [--draws N]");
        return ExitCode::from(2);
    };
    match coverage(usize::MAX, draws) {
        Ok(found) => {
            let is_good = |share: &f64| (BOUNDS[0]..=BOUNDS[1]).contains(share);
            for coverage in &found {
                println!("{:16} {:?} noise: {:?}", coverage.law, coverage.residuals, coverage.shares);
            }
            let are_good = found.iter().all(|coverage| coverage.shares.iter().all(is_good));
            if are_good { ExitCode::SUCCESS } else { ExitCode::from(4) }
        }
        Err(error) => {
            eprintln!("coverage: {error}");
            ExitCode::FAILURE
        }
    }
}
