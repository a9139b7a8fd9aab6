//! What is done with the page of an actuator, and what has to come of it.

use std::fs;
use std::path::Path;

use serde_json::Value;

use super::Results;
use super::browser::Browser;
use super::visit::{SCREENS, Screen, TOLERANCE, Visit, distance, expect};

/// Opens the report on a screen and uses it like somebody who wants to know: every control, or only what looks different by dark.
///
/// # Errors
/// The first thing that is not as it should be.
pub fn look(
    browser: &mut Browser,
    screen: &Screen,
    results: &Results,
    pictures: &Path,
    uses_every_control: bool,
) -> Result<(), String> {
    let mut visit = Visit { browser, screen, results, pictures };
    visit.open()?;
    visit.picture("1-first-look")?;
    let tip = visit.probe()?;
    visit.legend()?;
    visit.section()?;
    visit.theme()?;
    if uses_every_control {
        visit.slider(&tip)?;
        visit.keys_of_slider()?;
        visit.play()?;
        visit.more_fields()?;
        visit.range()?;
        visit.ticks()?;
        visit.without_perspective()?;
        visit.snapshot()?;
        visit.photo()?;
        visit.plots()?;
        visit.pointer_on_plots()?;
        visit.film()?;
        visit.cut()?;
        visit.close_readings()?;
        visit.views()?;
    }
    visit.whole_page()?;
    let complaints = visit.browser.complaints()?;
    expect(complaints.is_empty(), || format!("the page complains: {complaints:?}"))
}

/// The tip's node, and what the summary says of it at the highest pressure.
struct Tip {
    node: usize,
    at: [f64; 3],
    displacement: Vec<f64>,
}

impl Visit<'_> {
    fn tip(&self) -> Result<Tip, String> {
        let summary = &self.results.summary;
        let node = summary["probes"]["tip"]["node"].as_u64().ok_or("the case has no probe `tip`")? as usize;
        let steps = summary["steps"].as_array().ok_or("no steps")?;
        let last = steps.iter().rfind(|step| step["converged"] == true).ok_or("no pressure was reached")?;
        let u = last["probes"]["tip"].as_array().ok_or("no displacement of the tip")?;
        let displacement = u.iter().filter_map(Value::as_f64).collect();
        Ok(Tip { node, at: self.results.mesh()?.nodes[node], displacement })
    }

    /// Clicks the tip in the section along the body and reads its displacement.
    fn probe(&mut self) -> Result<Tip, String> {
        let tip = self.tip()?;
        self.click("#whole + span")?;
        self.click("[data-view=side]")?;
        let shown = self.browser.numbers(&format!("pneuflex.positionOf({})", tip.node))?;
        let expected: Vec<f64> = tip.at.iter().zip(&tip.displacement).map(|(x, u)| x + u).collect();
        expect(distance(&shown, &expected) < TOLERANCE, || format!("the tip is at {shown:?} instead of {expected:?}"))?;

        // A little inside the body, where the tip is the nearest node.
        let inside = self.results.mesh()?.nearest_node([tip.at[0] - 2.0, 0.0, 2.0]).ok_or("an empty mesh")?.0;
        self.browser.evaluate("document.getElementById('stage').scrollIntoView({block: 'center'})")?;
        let places = format!("[...pneuflex.placeOnPage({}), ...pneuflex.placeOnPage({inside})]", tip.node);
        let [x, y, u, v] = self.browser.numbers(&places)?[..] else { return Err("no place for the tip".into()) };
        let share = 2.0 / distance(&[x, y], &[u, v]);
        self.press([x + share * (u - x), y + share * (v - y)])?;
        let read = self.browser.numbers("pneuflex.reading?.displacement ?? []")?;
        expect(read.len() == 3 && distance(&read, &tip.displacement) < TOLERANCE, || {
            format!("a click on the tip reads a displacement of {read:?} instead of {:?}", tip.displacement)
        })?;
        let text = self.text("#probe")?;
        let row = text.lines().find_map(|line| line.strip_prefix("displacement")).unwrap_or_default();
        let numbers: Vec<f64> =
            row.replace('−', "-").split([',', '\t']).filter_map(|number| number.trim().parse().ok()).collect();
        expect(
            text.contains("tip") && numbers.len() == 3 && distance(&numbers, &tip.displacement) < TOLERANCE,
            || format!("the page reads {text:?} at the tip instead of {:?}", tip.displacement),
        )?;
        self.picture("2-probe")?;
        Ok(tip)
    }

    /// Drags the slider between two computed pressures: the body moves, the readings follow.
    fn slider(&mut self, tip: &Tip) -> Result<(), String> {
        let before = self.browser.numbers(&format!("pneuflex.positionOf({})", tip.node))?;
        self.browser.evaluate("document.getElementById('time').scrollIntoView({block: 'center'})")?;
        let [left, top, width, height] = self.area("#time")?;
        let at = |share: f64| [left + 10.0 + share * (width - 20.0), top + height / 2.0];
        let steps = (0..=12).map(|i| at(1.0 - 0.05 * f64::from(i))).collect::<Vec<_>>();
        self.browser.drag(&steps)?;
        let highest = self.browser.numbers("[Number(document.getElementById('time').max)]")?[0];
        let pressure = self.browser.numbers("[pneuflex.time]")?[0];
        expect((pressure / highest - 0.4).abs() < 0.05, || {
            format!("the slider was dragged to {pressure} of {highest} kPa")
        })?;
        let after = self.browser.numbers(&format!("pneuflex.positionOf({})", tip.node))?;
        let moved = distance(&before, &after);
        let whole = distance(&tip.displacement, &[0.0; 3]);
        expect(moved > 0.2 * whole && moved < whole, || format!("the tip moved by {moved} of {whole} mm"))?;
        let read = self.browser.numbers("pneuflex.reading.position")?;
        expect(distance(&read, &after) < 1e-9, || "the readings do not follow the slider".to_owned())?;
        let computed = self.browser.evaluate("pneuflex.isComputed")?;
        let origin = self.text("#origin")?;
        let said = if computed == true { origin == "computed" } else { origin.starts_with("interpolated between ") };
        expect(said, || format!("computed is {computed}, and the page says {origin:?}"))?;
        self.picture("3-dragged")?;

        // The last tick is the highest pressure, where the tip is back.
        self.click("#ticks button:last-child")?;
        let back = self.browser.numbers(&format!("pneuflex.positionOf({})", tip.node))?;
        expect(self.text("#origin")? == "computed" && distance(&back, &before) < 1e-6, || {
            "the tip does not come back".into()
        })
    }

    fn legend(&mut self) -> Result<(), String> {
        let first = self.text("#legend")?;
        expect(first.contains("von Mises stress, MPa"), || format!("the legend is {first:?}"))?;
        for (field, title) in [("displacement", "Displacement, mm"), ("contactPressure", "Contact pressure, kPa")] {
            self.click(&format!("input[value={field}] + span"))?;
            let legend = self.text("#legend")?;
            let marks = self.browser.numbers("pneuflex.legend")?;
            let even = marks.windows(2).all(|w| (w[1] - w[0] - marks[1]).abs() < 1e-9 * marks[1]);
            expect(legend.contains(title) && even && marks[0] == 0.0, || {
                format!("legend {legend:?}, marks {marks:?}")
            })?;
            if field == "displacement" {
                let top = marks[marks.len() - 1];
                let tip = distance(&self.tip()?.displacement, &[0.0; 3]);
                expect(top >= tip, || format!("the range of displacements ends at {top} mm, below the tip's {tip}"))?;
            }
            self.picture(&format!("4-{field}"))?;
        }
        self.click("input[value=vonMises] + span")
    }

    /// Goes through the list of further fields by the keyboard: each has its name and a range, and the values are those of the summary
    /// where it has them.
    fn more_fields(&mut self) -> Result<(), String> {
        let tip = self.tip()?;
        let names = self
            .browser
            .evaluate("[...document.querySelectorAll('#more-fields option')].slice(1).map((o) => o.value)")?;
        let names: Vec<String> = serde_json::from_value(names).map_err(|e| e.to_string())?;
        expect(names.len() == 12, || format!("the further fields are {names:?}"))?;
        self.browser.evaluate("document.getElementById('more-fields').focus()")?;
        for name in &names {
            self.browser.key("ArrowDown", 40)?;
            self.until_drawn()?;
            let field = self.browser.evaluate("pneuflex.field")?;
            expect(field == name.as_str(), || format!("{field} is shown instead of {name}"))?;
            let [low, high] = self.browser.numbers("pneuflex.colours")?[..] else { return Err("no colours".into()) };
            let value = self.browser.numbers(&format!("[pneuflex.valueAt({})]", tip.node))?[0];
            let is_signed = name != "stretch";
            expect(!is_signed || (low + high).abs() < 1e-9 * high, || format!("{name} goes from {low} to {high}"))?;
            expect(low < high && value.is_finite(), || format!("{name}: {value} between {low} and {high}"))?;
            let expected =
                ["ux", "uy", "uz"].iter().position(|component| component == name).map(|d| tip.displacement[d]);
            expect(expected.is_none_or(|u| (value - u).abs() < TOLERANCE), || {
                format!("{name} of the tip is {value}, not {expected:?}")
            })?;
            expect(name != "thickness" || (-0.9..0.9).contains(&value), || {
                format!("the thickness at the tip changes by {value}")
            })?;
            expect(name != "stretch" || low >= 1.0 - 0.01 && value > 0.99, || format!("stretch {value} from {low}"))?;
            if ["uz", "stretch", "sxx"].contains(&name.as_str()) {
                self.show_stage()?;
                self.picture(&format!("4-{name}"))?;
                self.browser.evaluate("document.getElementById('more-fields').focus()")?;
            }
        }
        Ok(())
    }

    /// Types the ends of the colours: they are those, and what lies beyond is said.
    fn range(&mut self) -> Result<(), String> {
        self.click("input[value=displacement] + span")?;
        let whole = self.browser.numbers("pneuflex.legend")?;
        for (field, text) in [("#low", "0.01"), ("#high", "0.25")] {
            self.click(field)?;
            self.browser.write(text)?;
        }
        self.until_drawn()?;
        let (colours, legend) = (self.browser.numbers("pneuflex.colours")?, self.text("#legend")?);
        let is_so = (colours[0] - 0.01).abs() < 1e-12 && (colours[1] - 0.25).abs() < 1e-12;
        expect(is_so && legend.contains("down to ") && legend.contains(" and up to "), || {
            format!("{colours:?}, {legend:?}")
        })?;
        self.show_stage()?;
        self.picture("4-range")?;
        // Another field has a range of its own again.
        self.click("input[value=vonMises] + span")?;
        self.click("input[value=displacement] + span")?;
        let again = self.browser.numbers("pneuflex.legend")?;
        expect(again == whole, || format!("the legend is {again:?} instead of {whole:?}"))
    }

    /// Seen from the side, lengths on the page are those of the body in all depths, as the bar says.
    fn without_perspective(&mut self) -> Result<(), String> {
        self.click("[data-view=side]")?;
        let [mm, pixels] = self.browser.numbers("pneuflex.scale")?[..] else { return Err("no scale".into()) };
        let near = self.results.mesh()?.nearest_node([0.0, 0.0, 0.0]).ok_or("an empty mesh")?.0;
        let far = self.results.mesh()?.nearest_node([99.0, 99.0, 0.0]).ok_or("an empty mesh")?.0;
        let places = format!(
            "[...pneuflex.placeOnPage({near}), ...pneuflex.placeOnPage({far}), ...pneuflex.positionOf({near}), ...pneuflex.positionOf({far})]"
        );
        let found = self.browser.numbers(&places)?;
        let [on_page, depth] = [distance(&found[..2], &found[2..4]), (found[5] - found[8]).abs()];
        let length = (found[4] - found[7]).hypot(found[6] - found[9]);
        let expected = length * pixels / mm;
        expect(depth > 1.0 && (on_page / expected - 1.0).abs() < 5e-3, || {
            format!("{length} mm in {depth} mm of depth are {on_page} pixels, by the bar {expected}")
        })?;
        self.show_stage()?;
        self.picture("4-side")
    }

    /// Saves a plot as numbers and as a picture, and plots one quantity over another.
    fn plots(&mut self) -> Result<(), String> {
        let folder = self.pictures.join(format!("saved-{}", self.screen.name));
        fs::create_dir_all(&folder).map_err(|e| e.to_string())?;
        self.browser.save_into(&folder)?;
        let buttons =
            [("#plots figure .saves button:first-child", "csv"), ("#plots figure .saves button:last-child", "png")];
        for (button, ending) in buttons {
            self.click(button)?;
            let bytes = self.saved(&folder, ending)?;
            if ending == "png" {
                expect(bytes.starts_with(b"\x89PNG") && bytes.len() > 3000, || {
                    format!("a picture of {} bytes", bytes.len())
                })?;
                continue;
            }
            let text = String::from_utf8(bytes).map_err(|e| e.to_string())?;
            let last = self.results.summary["steps"].as_array().and_then(|steps| steps.last()).ok_or("no steps")?;
            let numbers = text
                .lines()
                .last()
                .map(|line| line.split(',').filter_map(|x| x.parse::<f64>().ok()).collect::<Vec<_>>());
            let expected = [&last["pressure_kpa"], &last["end_face_angle_deg"]].map(|x| x.as_f64().unwrap_or(f64::NAN));
            let is_last =
                numbers.as_ref().is_some_and(|found| found.len() == 3 && distance(&found[..2], &expected) < 1e-6);
            expect(is_last && text.starts_with("\"pressure, kPa\",Bending angle: end face"), || {
                format!("the numbers are {text:?}")
            })?;
        }
        let before = self.text(".plots .own figcaption")?;
        self.browser.evaluate("document.getElementById('own-y').focus()")?;
        self.browser.key("ArrowDown", 40)?;
        let name = self.browser.evaluate("document.getElementById('own-y').selectedOptions[0].text")?;
        let after = self.text(".plots .own figcaption")?;
        let curves = self.browser.numbers("[document.querySelectorAll('.plots .own svg .line').length]")?;
        expect(before != after && after.starts_with(name.as_str().unwrap_or("?")) && curves == [1.0], || {
            format!("{name} is chosen, and the plot is {after:?} with {curves:?} curves")
        })
    }

    /// Records a film; on one screen, because it takes its time.
    fn film(&mut self) -> Result<(), String> {
        if self.screen.name != SCREENS[0].name {
            return Ok(());
        }
        let folder = self.pictures.join(format!("saved-{}", self.screen.name));
        self.click("#record")?;
        self.browser.wait_for("Number(document.getElementById('record').dataset.bytes) > 0")?;
        let film = self.saved(&folder, "webm")?;
        // EBML, by which Matroska begins.
        expect(film.starts_with(&[0x1A, 0x45, 0xDF, 0xA3]) && film.len() > 10_000, || {
            format!("a film of {} bytes", film.len())
        })?;
        let at = self.browser.numbers("[pneuflex.time, Number(document.getElementById('time').max)]")?;
        expect(at[0] == at[1], || format!("after the film the slider is at {}", at[0]))
    }

    fn section(&mut self) -> Result<(), String> {
        self.click("[data-view=iso]")?;
        self.click("#whole + span")?;
        for axis in ["x", "z", "y"] {
            self.click(&format!("input[name=section][value={axis}] + span"))?;
            let triangles = self.browser.numbers("pneuflex.section.triangles")?[0];
            expect(triangles > 20.0, || format!("a section across {axis} has {triangles} triangles"))?;
        }
        self.browser.evaluate("document.getElementById('stage').scrollIntoView()")?;
        self.picture("5-section")?;
        self.click("input[name=section][value=off] + span")?;
        let none = self.browser.evaluate("pneuflex.section === null")?;
        expect(none == true, || "the section stays when it is switched off".to_owned())
    }

    fn theme(&mut self) -> Result<(), String> {
        let is_dark = "getComputedStyle(document.documentElement).colorScheme === 'dark'";
        let expected = self.screen.scheme == "dark";
        for expected in [expected, !expected, expected] {
            let found = self.browser.evaluate(is_dark)?;
            expect(found == expected, || format!("dark is {found} instead of {expected}"))?;
            self.click("#theme")?;
        }
        // Once more than there and back.
        self.click("#theme")
    }

    fn whole_page(&mut self) -> Result<(), String> {
        self.browser.evaluate("scrollTo(0, 0)")?;
        self.capture("6-page", true)
    }
}
