//! The controls that show the same body otherwise: play, keys, views, turning, ticks, the cut, the plots under the pointer.

use std::fs;

use super::visit::{Visit, distance, expect};

/// Codes of keys.
const KEYS: [(&str, u32); 10] = [
    ("Home", 36),
    ("ArrowRight", 39),
    ("PageUp", 33),
    ("PageDown", 34),
    ("End", 35),
    ("2", 50),
    ("3", 51),
    ("0", 48),
    ("-", 189),
    ("Escape", 27),
];

impl Visit<'_> {
    fn press_key(&mut self, name: &str) -> Result<(), String> {
        let code = KEYS.iter().find(|(key, _)| *key == name).map_or(0, |(_, code)| *code);
        self.browser.key(name, code)?;
        self.until_drawn()
    }

    fn time(&mut self) -> Result<f64, String> {
        Ok(self.browser.numbers("[pneuflex.time]")?[0])
    }

    /// The slider by its keys: rest, a hundredth further, the next computed states, the end.
    pub fn keys_of_slider(&mut self) -> Result<(), String> {
        let [highest, first, second] =
            self.browser.numbers("[pneuflex.computed.at(-1), pneuflex.computed[1], pneuflex.computed[2]]")?[..]
        else {
            return Err("too few states".into());
        };
        self.browser.evaluate("document.getElementById('time').focus()")?;
        let goals = [
            ("Home", 0.0),
            ("ArrowRight", highest / 100.0),
            ("PageUp", first),
            ("PageUp", second),
            ("PageDown", first),
            ("End", highest),
        ];
        for (key, goal) in goals {
            self.press_key(key)?;
            let time = self.time()?;
            expect((time - goal).abs() < 1e-9 * highest, || format!("{key} goes to {time}, not to {goal}"))?;
        }
        Ok(())
    }

    /// Play, by a click and by the space bar, and pause.
    pub fn play(&mut self) -> Result<(), String> {
        let whole = self.time()?;
        self.click("#play")?;
        self.browser.wait_for(&format!("Math.abs(pneuflex.time - {whole}) > 0.01 * {whole}"))?;
        self.click("#play")?;
        let stopped = self.time()?;
        std::thread::sleep(std::time::Duration::from_millis(120));
        let later = self.time()?;
        expect(stopped == later, || format!("paused at {stopped}, it goes on to {later}"))?;
        self.browser.evaluate("document.getElementById('canvas').focus()")?;
        self.browser.key(" ", 32)?;
        self.browser.wait_for(&format!("Math.abs(pneuflex.time - {stopped}) > 0.002 * {whole}"))?;
        self.browser.key(" ", 32)?;
        self.click("#ticks button:last-child")
    }

    /// Views by buttons and keys; a drag turns, the wheel and keys zoom; Reset and Escape end readings.
    pub fn views(&mut self) -> Result<(), String> {
        let seen = "[pneuflex.direction.x, pneuflex.direction.y, pneuflex.direction.z]";
        for (button, key, expected) in [("front", "3", [1.0, 0.0, 0.0]), ("side", "2", [0.0, -1.0, 0.0])] {
            self.click("[data-view=iso]")?;
            self.click(&format!("[data-view={button}]"))?;
            let by_button = self.browser.numbers(seen)?;
            self.browser.evaluate("document.getElementById('canvas').focus()")?;
            self.press_key("0")?;
            self.press_key(key)?;
            let by_key = self.browser.numbers(seen)?;
            expect(distance(&by_button, &expected) < 1e-3 && distance(&by_key, &expected) < 1e-3, || {
                format!("from the {button}, one looks along {by_button:?}, by its key along {by_key:?}")
            })?;
        }
        self.click("[data-view=iso]")?;
        self.show_stage()?;
        let before = self.browser.numbers(seen)?;
        let [left, top, width, height] = self.area("#canvas")?;
        let at = |x: f64, y: f64| [left + x * width, top + y * height];
        if self.screen.is_phone() {
            self.browser.swipe(&[at(0.5, 0.6), at(0.6, 0.62), at(0.75, 0.65)])?;
        } else {
            self.browser.drag(&[at(0.5, 0.6), at(0.6, 0.62), at(0.75, 0.65)])?;
        }
        self.until_drawn()?;
        let turned = self.browser.numbers(seen)?;
        expect(distance(&before, &turned) > 0.1, || "a drag does not turn the view".to_owned())?;
        let length = self.browser.numbers("[pneuflex.distance]")?[0];
        self.browser.evaluate("document.getElementById('canvas').focus()")?;
        self.press_key("-")?;
        let by_key = self.browser.numbers("[pneuflex.distance]")?[0];
        self.browser.wheel(at(0.5, 0.5), -240.0)?;
        self.browser.wait_for(&format!("pneuflex.distance < 0.99 * {by_key}"))?;
        expect(by_key > 1.05 * length, || format!("the key zooms from {length} to {by_key}"))?;
        self.click("[data-view=reset]")?;
        self.until_still()?;
        let reset = self.browser.numbers(seen)?;
        let reads = self.browser.evaluate("pneuflex.reading === null && document.getElementById('probe').hidden")?;
        expect(distance(&before, &reset) < 1e-3 && reads == true, || format!("after a reset: {reset:?}, {reads}"))
    }

    /// A click reads, the cross and Escape close the readings.
    pub fn close_readings(&mut self) -> Result<(), String> {
        for by_key in [false, true] {
            self.show_stage()?;
            let [x, y] = self.browser.numbers("pneuflex.placeOnPage(0)")?[..] else { return Err("no place".into()) };
            let [left, top, width, height] = self.area("#canvas")?;
            // From a node at the clamp a little towards the middle of the view.
            let share = 0.06;
            self.press([x + share * (left + width / 2.0 - x), y + share * (top + height / 2.0 - y)])?;
            let open =
                self.browser.evaluate("pneuflex.reading !== null && !document.getElementById('probe').hidden")?;
            expect(open == true, || "a click on the body reads nothing".to_owned())?;
            if by_key {
                self.browser.evaluate("document.getElementById('canvas').focus()")?;
                self.press_key("Escape")?;
            } else {
                self.click("#probe button")?;
            }
            let is_closed = self.browser.evaluate("pneuflex.reading === null")?;
            expect(is_closed == true, || "the readings stay".to_owned())?;
        }
        Ok(())
    }

    /// The range fitted to the pressure; rest shape and lines of the mesh.
    pub fn ticks(&mut self) -> Result<(), String> {
        let whole = self.browser.numbers("pneuflex.colours")?;
        self.click("#ticks button:nth-child(2)")?;
        self.click("#fit + span")?;
        let fitted = self.browser.numbers("pneuflex.colours")?;
        expect(fitted[1] < whole[1], || format!("fitted, the colours go to {} as before", fitted[1]))?;
        self.click("#fit + span")?;
        self.click("#ticks button:last-child")?;
        for id in ["ghost", "mesh"] {
            let shown = format!("[Number(pneuflex.shows.{id})]");
            let before = self.browser.numbers(&shown)?;
            self.click(&format!("#{id} + span"))?;
            let after = self.browser.numbers(&shown)?;
            expect(before != after, || format!("{id} does nothing"))?;
            if id == "mesh" {
                self.show_stage()?;
                self.picture("4-mesh")?;
            }
            self.click(&format!("#{id} + span"))?;
        }
        Ok(())
    }

    /// The section's slider and its other side.
    pub fn cut(&mut self) -> Result<(), String> {
        self.click("input[name=section][value=x] + span")?;
        let before = self.browser.numbers("[pneuflex.section.at, pneuflex.section.side]")?;
        self.browser.evaluate("document.getElementById('cut').scrollIntoView({block: 'center'})")?;
        let [left, top, width, height] = self.area("#cut")?;
        let at = |share: f64| [left + 10.0 + share * (width - 20.0), top + height / 2.0];
        self.browser.drag(&[at(0.5), at(0.6), at(0.8)])?;
        self.click("#flip")?;
        let after = self.browser.numbers("[pneuflex.section.at, pneuflex.section.side]")?;
        let readout = self.text("#cut-readout")?;
        expect(after[0] > before[0] && after[1] == -before[1] && readout.starts_with("x = "), || {
            format!("the cut goes from {before:?} to {after:?}, {readout}")
        })?;
        self.click("input[name=section][value=off] + span")
    }

    /// A plot tells the value under the pointer, and a click goes there; any quantity can be along x.
    pub fn pointer_on_plots(&mut self) -> Result<(), String> {
        let plot = "#plots figure svg";
        self.browser.evaluate(&format!("document.querySelector({plot:?}).scrollIntoView({{block: 'center'}})"))?;
        let [left, top, width, height] = self.area(plot)?;
        let place = [left + 0.55 * width, top + 0.5 * height];
        if !self.screen.is_phone() {
            self.browser.hover(place)?;
            let hint = self.text(&format!("{plot} .hint"))?;
            expect(hint.contains("kPa: ") && hint.contains('°'), || format!("under the pointer: {hint:?}"))?;
        }
        self.press(place)?;
        let [time, highest] = self.browser.numbers("[pneuflex.time, pneuflex.computed.at(-1)]")?[..] else {
            return Err("no time".into());
        };
        expect((time / highest - 0.5).abs() < 0.1, || format!("a click on the plot goes to {time} of {highest}"))?;
        self.click("#ticks button:last-child")?;
        let before = self.text(".plots .own svg .texts")?;
        self.browser.evaluate("document.getElementById('own-x').focus()")?;
        self.browser.key("Home", 36)?;
        self.until_drawn()?;
        let after = self.text(".plots .own svg .texts")?;
        expect(before != after, || format!("another quantity along x leaves {before:?}"))
    }

    /// The view as a picture.
    pub fn snapshot(&mut self) -> Result<(), String> {
        let folder = self.pictures.join(format!("view-{}", self.screen.name));
        fs::create_dir_all(&folder).map_err(|e| e.to_string())?;
        self.browser.save_into(&folder)?;
        self.click("#snapshot")?;
        let bytes = self.saved(&folder, "png")?;
        expect(bytes.starts_with(b"\x89PNG") && bytes.len() > 10_000, || format!("a picture of {} bytes", bytes.len()))
    }

    /// A photo behind the side view: aligned by two points, it follows the body, and from elsewhere it is not shown.
    pub fn photo(&mut self) -> Result<(), String> {
        // The view itself, as it was saved, is a photo whose points are known.
        let folder = self.pictures.join(format!("view-{}", self.screen.name));
        let file = fs::read_dir(&folder).map_err(|e| e.to_string())?.flatten().next().ok_or("no picture")?.path();
        self.browser.choose_file("#photo-file", &file)?;
        self.browser.wait_for("pneuflex.photo.step === 0")?;
        self.show_stage()?;
        let [left, top, width, height] = self.area("#canvas")?;
        let at = |x: f64, y: f64| [left + x * width, top + y * height];
        // Twice the distance of the photo's points, and a little aside.
        let (body, photo) = ([at(0.2, 0.4), at(0.8, 0.4)], [at(0.35, 0.6), at(0.65, 0.6)]);
        let reading = "JSON.stringify(pneuflex.reading)";
        let read = self.browser.evaluate(reading)?;
        let before = self.browser.numbers("pneuflex.photo.map")?;
        let to_photo = |map: &[f64], page: [f64; 2]| {
            let [x, y] = [page[0] - left - map[4], page[1] - top - map[5]];
            let area = map[0] * map[3] - map[1] * map[2];
            [(x * map[3] - y * map[2]) / area, (y * map[0] - x * map[1]) / area]
        };
        for i in 0..2 {
            self.press(body[i])?;
            self.press(photo[i])?;
        }
        let said = self.text("#photo-step")?;
        let after = self.browser.numbers("pneuflex.photo.map")?;
        for i in 0..2 {
            let found = to_photo(&after, body[i]);
            let expected = to_photo(&before, photo[i]);
            expect(distance(&found, &expected) < 0.6, || {
                format!("point {i} of the photo is {found:?}, not {expected:?}")
            })?;
        }
        expect(said.starts_with("One millimetre is ") && said.ends_with("turned by 0.0°."), || said.clone())?;
        let later = self.browser.evaluate(reading)?;
        expect(read == later, || format!("clicks for the photo read {later}"))?;
        self.picture("4-photo")?;
        self.click("[data-view=iso]")?;
        self.until_still()?;
        let away = self.browser.evaluate("pneuflex.photo.isShown")?;
        expect(away == false, || "the photo is shown from elsewhere".to_owned())?;
        self.click("#photo-align")?;
        let again = self.browser.evaluate("pneuflex.photo.isShown && pneuflex.photo.step === 0")?;
        expect(again == true, || "it cannot be aligned again".to_owned())?;
        let see = self.area("#see-through")?;
        self.press([see[0] + 0.9 * see[2], see[1] + see[3] / 2.0])?;
        self.click("#photo-remove")?;
        let left = self.browser.evaluate(
            "pneuflex.photo.map === null && !pneuflex.photo.isShown && document.getElementById('canvas').style.opacity === ''",
        )?;
        expect(left == true, || "the photo stays".to_owned())
    }
}
