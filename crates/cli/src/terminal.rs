//! What is printed. Lines on a terminal are broken between words where it ends; what goes to a file or a pipe is not broken.

use std::io::{self, IsTerminal, Write};

use anstream::AutoStream;
use terminal_size::{Width, terminal_size_of};
use textwrap::{Options, WordSeparator, WordSplitter};

/// Columns of a terminal that does not say how many it has.
const USUAL: usize = 80;

/// Narrower than this nothing is readable.
const LEAST: usize = 20;

/// Further than the line itself, what goes on in the next line of the terminal is moved in by this.
const HANGING: usize = 2;

/// The texts of rows begin in this column.
const ROW: usize = 10;

/// Prints lines on standard error; nobody listening there is no reason to stop.
pub fn say(text: &str) {
    say_as_it_is(&message(text));
}

/// Prints on standard error what has its line breaks already, without its colours where that is no terminal.
pub fn say_as_it_is(text: &str) {
    let _ = writeln!(AutoStream::auto(io::stderr()), "{text}");
}

/// Prints rows of a name and a text on standard output; nobody reading on is no error.
pub fn print_rows(text: &str) {
    let broken = columns_of_output().map(|width| broken(text, width, ROW));
    let _ = io::stdout().write_all(broken.as_deref().unwrap_or(text).as_bytes());
}

/// A text as it is shown on standard error.
pub fn message(text: &str) -> String {
    columns_of_errors().map_or_else(|| text.to_owned(), |width| broken(text, width, HANGING))
}

/// Columns of the terminal that standard error goes to; `None` if it is none.
pub fn columns_of_errors() -> Option<usize> {
    let stream = io::stderr();
    columns(stream.is_terminal(), terminal_size_of(&stream).map(|(Width(width), _)| width))
}

/// Columns of the terminal that standard output goes to; `None` if it is none.
pub fn columns_of_output() -> Option<usize> {
    let stream = io::stdout();
    columns(stream.is_terminal(), terminal_size_of(&stream).map(|(Width(width), _)| width))
}

/// What `COLUMNS` says goes before what a terminal says of itself.
fn columns(is_terminal: bool, width: Option<u16>) -> Option<usize> {
    let wanted = std::env::var("COLUMNS").ok();
    is_terminal.then(|| chosen(wanted.as_deref(), width))
}

fn chosen(wanted: Option<&str>, width: Option<u16>) -> usize {
    let wanted = wanted.and_then(|text| text.trim().parse().ok()).filter(|columns| *columns > 0);
    let width = width.map(usize::from).filter(|columns| *columns > 0);
    wanted.or(width).unwrap_or(USUAL).max(LEAST)
}

/// A text in lines of at most so many columns; what goes on in a next line is moved in by `hanging` from the line that it belongs to. Words
/// that are longer, as paths may be, stay whole.
fn broken(text: &str, width: usize, hanging: usize) -> String {
    let broken_line = |line: &str| {
        let content = line.trim_start();
        let indentation = &line[..line.len() - content.len()];
        let next = format!("{indentation}{}", " ".repeat(hanging));
        let options = Options::new(width)
            .initial_indent(indentation)
            .subsequent_indent(&next)
            .break_words(false)
            .word_separator(WordSeparator::AsciiSpace)
            .word_splitter(WordSplitter::NoHyphenation);
        textwrap::fill(content, options)
    };
    text.split('\n').map(broken_line).collect::<Vec<_>>().join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_broken_between_words() {
        let text = "warning: one two three four\n  what to do: five six seven eight";
        let lines = "warning: one two\n  three four\n  what to do: five\n    six seven eight";
        assert_eq!(broken(text, 20, HANGING), lines);
        assert_eq!(broken(text, 80, HANGING), text);
        assert_eq!(broken("  short\n", 80, HANGING), "  short\n");
        let path = "/a/path".repeat(20);
        assert_eq!(broken(&format!("wrote {path}"), 80, HANGING), format!("wrote\n  {path}"));
        assert_eq!(broken("support   held in x", 15, ROW), format!("support   held\n{}in x", " ".repeat(ROW)));
    }

    #[test]
    fn a_terminal_has_as_many_columns_as_it_is_told_or_says() {
        assert_eq!(columns(false, Some(80)), None);
        assert_eq!(
            [Some("100"), Some("0"), Some("wide"), None].map(|wanted| chosen(wanted, Some(72))),
            [100, 72, 72, 72]
        );
        assert_eq!((chosen(None, None), chosen(None, Some(0)), chosen(Some("3"), None)), (80, 80, LEAST));
    }
}
