//! Elements of XML with their lines, and what is complained about.

use std::collections::BTreeMap;

use pneuflex_model::Curve;
pub(super) use roxmltree::Node;

use super::curves::LoadCurve;
use crate::report::{Place, Report, quoted, suggestion};
use crate::syntax::{integer, real};

/// What every reader of a section needs.
pub(super) struct Reader<'a> {
    /// Where lines begin.
    pub lines: Vec<usize>,
    pub report: &'a mut Report,
    /// Load curves by number.
    pub curves: BTreeMap<i32, LoadCurve>,
    /// When the last step ends.
    pub end: f64,
}

impl Reader<'_> {
    pub fn place(&self, node: Node<'_, '_>) -> Place {
        Place { file: 0, line: self.lines.partition_point(|begin| *begin <= node.range().start) as u32 }
    }

    pub fn error(&mut self, node: Node<'_, '_>, text: impl Into<String>) {
        self.report.error(self.place(node), text);
    }

    pub fn note(&mut self, node: Node<'_, '_>, text: impl Into<String>) {
        self.report.note(self.place(node), text);
    }

    /// Complains about every child that is not called by one of the names.
    pub fn only(&mut self, node: Node<'_, '_>, names: &[&str]) {
        for child in elements(node) {
            let name = child.tag_name().name();
            if !names.contains(&name) {
                let hint = suggestion(name, names.iter().copied());
                self.error(child, format!("<{name}> in <{}> is not supported{hint}", node.tag_name().name()));
            }
        }
    }

    /// An attribute that must be there.
    pub fn required<'a>(&mut self, node: Node<'a, '_>, name: &str) -> Option<&'a str> {
        let found = node.attribute(name).map(str::trim).filter(|value| !value.is_empty());
        if found.is_none() {
            self.error(node, format!("<{}> needs {name}=\"…\"", node.tag_name().name()));
        }
        found
    }

    /// A child that must be there.
    pub fn required_child<'a, 'i>(&mut self, node: Node<'a, 'i>, name: &str) -> Option<Node<'a, 'i>> {
        let found = child(node, name);
        if found.is_none() {
            self.error(node, format!("<{}> needs <{name}>", node.tag_name().name()));
        }
        found
    }

    /// The number that an element holds.
    pub fn real(&mut self, node: Node<'_, '_>) -> Option<f64> {
        if node.attribute("type").is_some_and(|kind| kind != "const") {
            self.error(node, format!("<{}> is the same everywhere: no map and no formula", node.tag_name().name()));
            return None;
        }
        self.parsed(node, text(node), real)
    }

    /// The numbers that an element holds, between commas or spaces.
    pub fn reals(&mut self, node: Node<'_, '_>) -> Option<Vec<f64>> {
        entries(node).map(|entry| self.parsed(node, entry, real)).collect()
    }

    /// The whole number that an element holds.
    pub fn integer(&mut self, node: Node<'_, '_>) -> Option<i32> {
        self.parsed(node, text(node), integer)
    }

    /// The numbers of nodes and elements that an element holds.
    pub fn tags(&mut self, node: Node<'_, '_>) -> Vec<u64> {
        entries(node).filter_map(|entry| self.parsed(node, entry, tag)).collect()
    }

    /// The number of an element of the file.
    pub fn id(&mut self, node: Node<'_, '_>) -> Option<u64> {
        let written = self.required(node, "id")?;
        self.parsed(node, written, tag)
    }

    /// Whether a child that is 0 or 1 is 1; without it `otherwise`.
    pub fn flag(&mut self, node: Node<'_, '_>, name: &str, otherwise: bool) -> bool {
        let Some(child) = child(node, name) else { return otherwise };
        match text(child) {
            "0" | "false" => false,
            "1" | "true" => true,
            other => {
                self.error(child, format!("<{name}> is {}, not 0 or 1", quoted(other)));
                otherwise
            }
        }
    }

    /// A number over time: it times the load curve of its attribute `lc`.
    pub fn history(&mut self, node: Node<'_, '_>) -> Option<Curve> {
        let factor = self.real(node)?;
        self.history_of(node, factor)
    }

    /// A factor times the load curve that the attribute `lc` of an element names; without one it acts from the beginning.
    pub fn history_of(&mut self, node: Node<'_, '_>, factor: f64) -> Option<Curve> {
        let Some(written) = node.attribute("lc") else {
            let text = "a value without a load curve grows over the first thousandth of the time instead of jumping";
            self.note(node, text);
            return Some(LoadCurve::constant().times(factor, self.end));
        };
        let number = self.parsed(node, written, integer)?;
        let found =
            self.curves.get(&number).map(|curve| curve.usable(self.end).map(|()| curve.times(factor, self.end)));
        match found {
            Some(Ok(curve)) => Some(curve),
            Some(Err(why)) => {
                self.error(node, format!("load curve {number}: {why}"));
                None
            }
            None => {
                self.error(node, format!("there is no load curve {number}"));
                None
            }
        }
    }

    fn parsed<T>(&mut self, node: Node<'_, '_>, text: &str, parse: impl Fn(&str) -> Result<T, String>) -> Option<T> {
        parse(text).map_err(|why| self.error(node, format!("<{}>: {why}", node.tag_name().name()))).ok()
    }
}

fn tag(text: &str) -> Result<u64, String> {
    text.parse::<u32>()
        .map(u64::from)
        .map_err(|_| format!("{} is not the number of a node or an element", quoted(text)))
}

/// Children that are elements.
pub(super) fn elements<'a, 'i>(node: Node<'a, 'i>) -> impl Iterator<Item = Node<'a, 'i>> {
    node.children().filter(Node::is_element)
}

/// The first child of a name.
pub(super) fn child<'a, 'i>(node: Node<'a, 'i>, name: &str) -> Option<Node<'a, 'i>> {
    elements(node).find(|child| child.has_tag_name(name))
}

/// All children of a name.
pub(super) fn children<'a, 'i>(node: Node<'a, 'i>, name: &'static str) -> impl Iterator<Item = Node<'a, 'i>> {
    elements(node).filter(move |child| child.has_tag_name(name))
}

/// The text of an element.
pub(super) fn text<'a>(node: Node<'a, '_>) -> &'a str {
    node.text().unwrap_or_default().trim()
}

/// Entries between commas or white space.
pub(super) fn entries<'a>(node: Node<'a, '_>) -> impl Iterator<Item = &'a str> {
    node.text().unwrap_or_default().split([',', ' ', '\t', '\n', '\r']).filter(|entry| !entry.is_empty())
}
