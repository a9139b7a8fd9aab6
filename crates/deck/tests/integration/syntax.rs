//! Keywords, parameters, data lines, included files; hostile texts.

use pneuflex_deck::syntax::{Block, MAX_DEPTH, MAX_FILES, Sources, parse};
use proptest::prelude::*;

fn none(name: &str) -> Result<Vec<u8>, String> {
    Err(format!("no file {name}"))
}

fn read(text: &str) -> (Sources, Vec<Block>) {
    parse("a.inp", text.into(), &mut none).unwrap()
}

fn errors(text: &str) -> Vec<String> {
    parse("a.inp", text.into(), &mut none).unwrap_err().iter().map(ToString::to_string).collect()
}

#[test]
fn keywords_parameters_and_data_are_found_in_any_spelling() {
    let text = "\u{feff}** a comment\r\n*Solid  section , ElSet = Body,\r\n** between\r\n  material=\"Dragon Skin, 30\"\r\n\r\n 1., ,2.,,\r\n\
                *NODE\n\t1 ,0. , .5,1.D0\n** the end";
    let (sources, blocks) = read(text);
    assert_eq!(blocks.len(), 2);
    assert_eq!((blocks[0].keyword.as_str(), blocks[0].place.line), ("SOLIDSECTION", 2));
    assert_eq!(blocks[0].written, "*Solid  section");
    assert_eq!(blocks[0].value("ELSET"), Some("Body"));
    assert_eq!(blocks[0].value("MATERIAL"), Some("Dragon Skin, 30"));
    assert_eq!(sources.fields(&blocks[0].lines[0]), ["1.", "", "2."]);
    assert_eq!((blocks[1].lines[0].place.line, sources.text(&blocks[1].lines[0])), (8, "1 ,0. , .5,1.D0"));
    assert_eq!(sources.fields(&blocks[1].lines[0]), ["1", "0.", ".5", "1.D0"]);
}

#[test]
fn included_files_stand_in_for_their_line_and_keep_their_places() {
    let mut include = |name: &str| match name {
        "Mesh/Nodes.inc" => Ok(b"** nodes\n1, 0., 0., 0.\n*ELEMENT, TYPE=C3D8\n9".to_vec()),
        "set.txt" => Ok(b"4, 5".to_vec()),
        _ => none(name),
    };
    let text = "*NODE\n*include, Input=Mesh/Nodes.inc\n10\n*NSET, NSET=A, INPUT=set.txt\n6\n";
    let (sources, blocks) = parse("a.inp", text.into(), &mut include).unwrap();
    let keywords: Vec<_> = blocks.iter().map(|block| block.keyword.as_str()).collect();
    assert_eq!(keywords, ["NODE", "ELEMENT", "NSET"]);
    let lines = |block: &Block| -> Vec<_> {
        let place = |line: &pneuflex_deck::syntax::DataLine| (line.place.file, line.place.line);
        block.lines.iter().map(|line| (place(line), sources.text(line).to_owned())).collect()
    };
    assert_eq!(lines(&blocks[0]), [((1, 2), "1, 0., 0., 0.".to_owned())]);
    // Data after the included file belongs to its last keyword.
    assert_eq!(lines(&blocks[1]), [((1, 4), "9".to_owned()), ((0, 3), "10".to_owned())]);
    assert_eq!(lines(&blocks[2]), [((2, 1), "4, 5".to_owned()), ((0, 5), "6".to_owned())]);
    assert_eq!(sources.names, ["a.inp", "Mesh/Nodes.inc", "set.txt"]);
}

#[test]
fn what_is_not_of_the_language_is_told_by_file_and_line() {
    assert_eq!(errors("1, 2\n*NODE\n"), ["a.inp:1: a deck begins with a keyword, such as *HEADING or *NODE"]);
    assert_eq!(errors("*NODE\n*\n"), ["a.inp:2: an asterisk without a keyword"]);
    assert_eq!(errors("*NODE, NSET=\"A\n"), ["a.inp:1: a name is not closed: an odd number of double quotes"]);
    assert_eq!(errors("*NODE\n*INCLUDE, INPT=b\n"), ["a.inp:2: *INCLUDE needs INPUT=file; did you mean INPUT?"]);
    assert_eq!(errors("*INCLUDE, INPUT=b.inc\n"), ["a.inp:1: \"b.inc\" cannot be included: no file b.inc"]);
    assert_eq!(errors("*NODE\n\0\n"), ["a.inp:1: \"a.inp\" is not a text"]);
}

#[test]
fn files_that_include_themselves_or_each_other_end_with_one_error() {
    let found = |deck: &str, include: &dyn Fn(&str) -> String| {
        let mut opened = 0;
        let mut counted = |name: &str| {
            opened += 1;
            Ok(include(name).into_bytes())
        };
        let found = parse("folder/a.inp", deck.into(), &mut counted).unwrap_err();
        assert_eq!(found.len(), 1, "{found:?}");
        (opened, found[0].text.clone())
    };
    // Three times itself: 3^15 files, were the first not noticed.
    let thrice = "*HEADING\n".to_owned() + &"*INCLUDE, INPUT=./a.inp\n".repeat(3);
    assert_eq!(found(&thrice, &|_| thrice.clone()).0, 0);
    let (opened, text) = found("*INCLUDE, INPUT=b.inc\n", &|name| match name {
        "b.inc" => "*INCLUDE, INPUT=c.inc\n".into(),
        _ => "*INCLUDE, INPUT=.\\b.inc\n".into(),
    });
    assert_eq!(
        (opened, &*text),
        (2, "a file includes itself without end: \"b.inc\" includes \"c.inc\" includes \"b.inc\"")
    );
    // Ever new names.
    let (opened, text) = found("*INCLUDE, INPUT=b\n", &|name| format!("*INCLUDE, INPUT={name}b\n").repeat(4));
    assert!(text.contains("include each other more than 16 deep"), "{text}");
    assert_eq!(opened, MAX_DEPTH - 1);
    // A tree of 4^14 files.
    let (opened, text) = found("*INCLUDE, INPUT=b0\n", &|name| {
        let level: usize = name[1..].parse().unwrap();
        if level < 14 { format!("*INCLUDE, INPUT=b{}\n", level + 1).repeat(4) } else { "*NODE\n".into() }
    });
    assert!(text.contains("more than 1000 files"), "{text}");
    assert_eq!(opened, MAX_FILES);
}

proptest! {
    #[test]
    fn any_bytes_are_read_or_refused(bytes in proptest::collection::vec(any::<u8>(), 0..400)) {
        let _ = parse("a.inp", bytes, &mut none);
    }

    #[test]
    fn every_line_of_data_is_found_once(
        lines in proptest::collection::vec("(\\*{0,2}[A-Za-z ,=\".0-9é]{0,12})", 0..30)
    ) {
        let text = format!("*NODE\n{}", lines.join("\n"));
        let Ok((sources, blocks)) = parse("a.inp", text.clone().into(), &mut none) else { return Ok(()) };
        let texts: Vec<&str> = text.split('\n').map(str::trim).collect();
        for block in &blocks {
            for line in &block.lines {
                prop_assert_eq!(sources.text(line), texts[line.place.line as usize - 1]);
                prop_assert!(!sources.text(line).starts_with('*'));
                sources.fields(line);
            }
        }
    }
}
