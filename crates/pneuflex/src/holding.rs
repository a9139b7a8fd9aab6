//! Whether anything holds the body, found out before it is solved.

use pneuflex_model::Problem;
use pneuflex_newton::{LoosePart, loose_parts, springs_of};

use crate::advice::Occasion;
use crate::input_error::InputError;
use crate::vocabulary::Vocabulary;
use crate::words::plural;

/// So many loose parts are described; of the others there is the number.
const DESCRIBED: usize = 3;

/// What to know of parts that only contact may hold; in words.
///
/// # Errors
/// Parts that nothing holds, with the motions that are free.
pub fn check(problem: &Problem, vocabulary: Vocabulary) -> Result<Option<String>, InputError> {
    let (touching, free): (Vec<LoosePart>, Vec<LoosePart>) =
        loose_parts(problem).into_iter().partition(|part| part.may_be_held_by_contact);
    if !free.is_empty() {
        let all_six = |part: &LoosePart| part.motions.count() == 6;
        let message = match &free[..] {
            [part] if is_whole(part, problem) && all_six(part) => {
                format!("nothing holds the body: it is free {}", part.motions)
            }
            [part] if is_whole(part, problem) => format!("the body is not held: it is free {}", part.motions),
            parts => format!("{} not held by anything: {}", are(parts), described(problem, parts)),
        };
        return Err(InputError::new(message).with_help(Some(vocabulary.advice(Occasion::Free, problem))));
    }
    let springs: f64 = springs_of(problem).iter().map(|(_, stiffness)| stiffness).sum();
    Ok((!touching.is_empty()).then(|| {
        format!(
            "{}; springs of {springs:.2e} N/mm in all help until contact does: they follow the body, and carry nothing in any \
             result (states on the way to one may lean on them)",
            held_by_contact(problem, &touching)
        )
    }))
}

/// What contact alone may hold, in words.
pub fn held_by_contact(problem: &Problem, parts: &[LoosePart]) -> String {
    let which = match parts {
        [part] if is_whole(part, problem) => format!("the body: without it, it is free {}", part.motions),
        parts => format!("{}: without it, {}", plural(parts.len(), "part"), described(problem, parts)),
    };
    format!("only contact holds {which}")
}

fn are(parts: &[LoosePart]) -> String {
    match parts {
        [_] => "a part of the body is".into(),
        parts => format!("{} parts of the body are", parts.len()),
    }
}

fn is_whole(part: &LoosePart, problem: &Problem) -> bool {
    part.elements.len() == problem.mesh.num_elements()
}

fn described(problem: &Problem, parts: &[LoosePart]) -> String {
    let of_part = |part: &LoosePart| {
        let sets = &problem.mesh.element_sets;
        let name = sets.iter().find(|(_, elements)| **elements == part.elements).map(|(name, _)| format!("{name}, "));
        let elements = plural(part.elements.len(), "element");
        let [x, y, z] = part.centre;
        format!("{}{elements} around ({x:.2}, {y:.2}, {z:.2}) mm, is free {}", name.unwrap_or_default(), part.motions)
    };
    let mut texts: Vec<String> = parts.iter().take(DESCRIBED).map(of_part).collect();
    if parts.len() > DESCRIBED {
        texts.push(format!("and so on for {} more", parts.len() - DESCRIBED));
    }
    texts.join("; ")
}
