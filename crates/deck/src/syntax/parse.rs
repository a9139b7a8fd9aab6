//! Lines → keywords with parameters and data, through included files.

use super::block::{Block, DataLine, Parameter, Sources, bare, fields, unquoted};
use crate::report::{DeckError, Place, Report, quoted, suggestion};

/// So deep may files include each other.
pub const MAX_DEPTH: usize = 16;

/// So many files may a deck include in all.
pub const MAX_FILES: usize = 1000;

/// Bytes of a deck with all its included files, at the most.
pub const MAX_SIZE: usize = 1 << 30;

/// Finds an included file: its name as the deck writes it → its bytes, or why there are none.
pub type Include<'a> = dyn FnMut(&str) -> Result<Vec<u8>, String> + 'a;

/// Reads a deck called `name` from its bytes into keywords; what is wrong goes to the report.
pub fn parse_into(name: &str, text: Vec<u8>, include: &mut Include<'_>, report: &mut Report) -> (Sources, Vec<Block>) {
    let (sources, blocks, open) = Default::default();
    let mut parser = Parser { sources, blocks, include, report, size: 0, open, has_given_up: false };
    parser.file(name, text, None);
    (parser.sources, parser.blocks)
}

/// Reads a deck called `name` from its bytes into keywords.
///
/// Bytes that are not UTF-8 are replaced; comments of old decks have such.
///
/// # Errors
/// Every line that is not of the language, every included file that cannot be had.
pub fn parse(name: &str, text: Vec<u8>, include: &mut Include<'_>) -> Result<(Sources, Vec<Block>), Vec<DeckError>> {
    let mut report = Report::default();
    let (sources, blocks) = parse_into(name, text, include, &mut report);
    report.finish(&sources.names).map(|_| (sources, blocks))
}

struct Parser<'a, 'b> {
    sources: Sources,
    blocks: Vec<Block>,
    include: &'a mut Include<'b>,
    report: &'a mut Report,
    size: usize,
    /// Names of the files that are being read, each included by the one before it.
    open: Vec<String>,
    /// Whether there is no end of included files: nothing more is read.
    has_given_up: bool,
}

/// A line without blanks around it.
struct Line {
    place: Place,
    start: usize,
    end: usize,
}

impl Parser<'_, '_> {
    /// Reads one file; `from` is where it is included.
    fn file(&mut self, name: &str, bytes: Vec<u8>, from: Option<Place>) {
        let file = self.sources.names.len() as u32;
        let at = from.unwrap_or(Place { file, line: 1 });
        self.size += bytes.len();
        self.sources.names.push(name.to_owned());
        self.sources.texts.push(String::new());
        if self.size > MAX_SIZE {
            return self.give_up(at, format!("the deck with what it includes is larger than {} MiB", MAX_SIZE >> 20));
        }
        if bytes.contains(&0) {
            return self.report.error(at, format!("{} is not a text", quoted(name)));
        }
        let text =
            String::from_utf8(bytes).unwrap_or_else(|error| String::from_utf8_lossy(error.as_bytes()).into_owned());
        let lines = lines(&text, file);
        self.sources.texts[file as usize] = text;
        // Included files are named from the folder of the deck.
        let name = if from.is_some() { name } else { name.rsplit(['/', '\\']).next().unwrap_or(name) };
        self.open.push(plain(name));
        self.lines(&lines);
        self.open.pop();
    }

    /// One error instead of one for every file that is still to come.
    fn give_up(&mut self, place: Place, why: String) {
        self.report.error(place, why);
        self.has_given_up = true;
    }

    fn lines(&mut self, lines: &[Line]) {
        let mut rest = lines;
        while let [first, after @ ..] = rest
            && !self.has_given_up
        {
            rest = after;
            if !self.text(first).starts_with('*') {
                self.data(first);
                continue;
            }
            let mut head = self.text(first).to_owned();
            while head.ends_with(',')
                && let [next, after @ ..] = rest
                && !self.text(next).starts_with('*')
            {
                head += self.text(next);
                rest = after;
            }
            self.keyword(first.place, &head);
        }
    }

    fn text(&self, line: &Line) -> &str {
        &self.sources.texts[line.place.file as usize][line.start..line.end]
    }

    fn data(&mut self, line: &Line) {
        match self.blocks.last_mut() {
            // Fewer than 2³² bytes in all.
            Some(block) => block.lines.push(DataLine { place: line.place, bytes: line.start as u32..line.end as u32 }),
            None => self.report.error(line.place, "a deck begins with a keyword, such as *HEADING or *NODE"),
        }
    }

    fn keyword(&mut self, place: Place, head: &str) {
        let mut pieces = fields(head);
        let written = pieces.next().unwrap_or_default();
        let keyword = bare(written.trim_start_matches('*'));
        if keyword.is_empty() {
            return self.report.error(place, "an asterisk without a keyword");
        }
        if head.matches('"').count() % 2 == 1 {
            return self.report.error(place, "a name is not closed: an odd number of double quotes");
        }
        let parameters: Vec<Parameter> = pieces
            .filter(|piece| !piece.is_empty())
            .map(|piece| match piece.split_once('=') {
                Some((name, value)) => {
                    Parameter { name: bare(name), value: Some(unquoted(value.trim()).trim().to_owned()) }
                }
                None => Parameter { name: bare(piece), value: None },
            })
            .collect();
        let written: String = written.chars().take(40).collect();
        let block = Block { keyword, written, place, parameters, lines: Vec::new() };
        // Other keywords may take their data from a file, too.
        let input = block.value("INPUT").map(str::to_owned);
        match (block.keyword == "INCLUDE", input) {
            (true, None) => {
                let hint = block.parameters.first().map(|p| suggestion(&p.name, ["INPUT"])).unwrap_or_default();
                self.report.error(place, format!("*INCLUDE needs INPUT=file{hint}"));
            }
            (true, Some(input)) => self.include(place, &input),
            (false, None) => self.blocks.push(block),
            (false, Some(input)) => {
                self.blocks.push(block);
                self.include(place, &input);
            }
        }
    }

    fn include(&mut self, place: Place, input: &str) {
        let name = plain(input);
        if let Some(first) = self.open.iter().position(|open| *open == name) {
            let chain = self.open[first..].iter().chain([&name]).map(|name| quoted(name)).collect::<Vec<_>>();
            return self.give_up(place, format!("a file includes itself without end: {}", chain.join(" includes ")));
        }
        if self.open.len() >= MAX_DEPTH {
            return self.give_up(place, format!("files include each other more than {MAX_DEPTH} deep"));
        }
        if self.sources.names.len() > MAX_FILES {
            return self.give_up(place, format!("the deck includes more than {MAX_FILES} files"));
        }
        match (self.include)(input) {
            Ok(bytes) => {
                self.file(input, bytes, Some(place));
            }
            Err(why) => self.report.error(place, format!("{} cannot be included: {why}", quoted(input))),
        }
    }
}

/// A file's name, so that one file has one name however a deck writes it.
fn plain(name: &str) -> String {
    let name = name.replace('\\', "/");
    name.strip_prefix("./").unwrap_or(&name).to_owned()
}

/// Lines that are neither blank nor comments.
fn lines(text: &str, file: u32) -> Vec<Line> {
    let mut found = Vec::new();
    let mut start = 0;
    for (number, line) in (1..).zip(text.split('\n')) {
        let trimmed = line.trim_matches(|c: char| c.is_whitespace() || c == '\u{feff}');
        if !trimmed.is_empty() && !trimmed.starts_with("**") {
            let from = start + (trimmed.as_ptr() as usize - line.as_ptr() as usize);
            found.push(Line { place: Place { file, line: number }, start: from, end: from + trimmed.len() });
        }
        start += line.len() + 1;
    }
    found
}
