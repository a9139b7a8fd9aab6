//! A visit to a page: what is done with it by mouse, finger and keys, and what is read off it.

use std::fs;
use std::path::Path;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::json;

use super::Results;
use super::browser::Browser;

/// A device the page is looked at on.
pub struct Screen {
    /// Name of the pictures.
    pub name: &'static str,
    width: u32,
    height: u32,
    is_phone: bool,
    /// `light` or `dark`.
    pub scheme: &'static str,
}

impl Screen {
    /// Whether it is used by fingers.
    pub fn is_phone(&self) -> bool {
        self.is_phone
    }
}

/// Desk and phone, light and dark.
pub const SCREENS: [Screen; 4] = [
    Screen { name: "desktop-light", width: 1440, height: 900, is_phone: false, scheme: "light" },
    Screen { name: "desktop-dark", width: 1440, height: 900, is_phone: false, scheme: "dark" },
    Screen { name: "phone-light", width: 390, height: 844, is_phone: true, scheme: "light" },
    Screen { name: "phone-dark", width: 390, height: 844, is_phone: true, scheme: "dark" },
];

/// Height of a slice of a page, px.
const SLICE: f64 = 1600.0;

/// mm by which positions in the page may differ from those of the summary: well above the 16-bit steps of displacements of
/// 100 mm, far below what anybody looks at.
pub const TOLERANCE: f64 = 2e-3;

/// A page that is looked at on a screen.
pub struct Visit<'a> {
    pub browser: &'a mut Browser,
    pub screen: &'a Screen,
    pub results: &'a Results,
    pub pictures: &'a Path,
}

/// Opens the report of a run.
///
/// # Errors
/// The browser's.
pub fn open(browser: &mut Browser, results: &Results) -> Result<(), String> {
    let page = results.folder.join("report.html");
    browser.call("Page.navigate", &json!({"url": format!("file://{}", page.display())}))?;
    browser.wait_for("window.pneuflex && document.readyState === 'complete'")
}

/// An error unless something holds.
///
/// # Errors
/// What `otherwise` says.
pub fn expect(holds: bool, otherwise: impl FnOnce() -> String) -> Result<(), String> {
    if holds { Ok(()) } else { Err(otherwise()) }
}

/// Distance of two points.
pub fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}

impl Visit<'_> {
    pub fn open(&mut self) -> Result<(), String> {
        let Screen { width, height, is_phone, scheme, .. } = *self.screen;
        let scale = if is_phone { 2 } else { 1 };
        let size = json!({"width": width, "height": height, "deviceScaleFactor": scale, "mobile": is_phone});
        self.browser.call("Emulation.setDeviceMetricsOverride", &size)?;
        let touch = json!({"enabled": is_phone, "maxTouchPoints": 2});
        self.browser.call("Emulation.setTouchEmulationEnabled", &touch)?;
        let features = json!({"features": [
            {"name": "prefers-color-scheme", "value": scheme}, {"name": "prefers-reduced-motion", "value": "reduce"}
        ]});
        self.browser.call("Emulation.setEmulatedMedia", &features)?;
        open(self.browser, self.results)?;
        let wide = self.browser.evaluate("document.documentElement.scrollWidth - innerWidth")?;
        expect(wide.as_i64() <= Some(0), || format!("the page is {wide} pixels wider than the screen"))
    }

    /// Clicks the centre of the first obstacle.
    pub fn press_on_ball(&mut self) -> Result<(), String> {
        self.browser.evaluate("document.getElementById('stage').scrollIntoView({block: 'center'})")?;
        let place = self.browser.numbers("pneuflex.obstacles[0].onPage")?;
        self.press(place.try_into().map_err(|_| "the ball is nowhere on the page".to_owned())?)
    }

    /// The bytes of a file that the page saves.
    pub fn saved(&mut self, folder: &Path, ending: &str) -> Result<Vec<u8>, String> {
        for _ in 0..200 {
            let entries = fs::read_dir(folder).map_err(|e| e.to_string())?.flatten();
            if let Some(file) =
                entries.map(|entry| entry.path()).find(|path| path.extension().is_some_and(|e| e == ending))
            {
                // It is there before it is written.
                let bytes = fs::read(file).map_err(|e| e.to_string())?;
                if !bytes.is_empty() {
                    return Ok(bytes);
                }
            }
            std::thread::sleep(std::time::Duration::from_millis(50));
        }
        Err(format!("no .{ending} was saved"))
    }

    pub fn show_stage(&mut self) -> Result<(), String> {
        self.browser.evaluate("document.getElementById('stage').scrollIntoView({block: 'center'})").map(drop)
    }

    /// Clicks the middle of an element.
    pub fn click(&mut self, selector: &str) -> Result<(), String> {
        self.browser.evaluate(&format!("document.querySelector({selector:?}).scrollIntoView({{block: 'center'}})"))?;
        let [left, top, width, height] = self.area(selector)?;
        self.press([left + width / 2.0, top + height / 2.0])
    }

    /// A click, or on a phone a tap.
    pub fn press(&mut self, place: [f64; 2]) -> Result<(), String> {
        if self.screen.is_phone {
            self.browser.tap(place)?
        } else {
            self.browser.drag(&[place])?
        }
        self.until_drawn()
    }

    /// Waits until the page shows what was asked of it; the camera is not where it should be before.
    pub fn until_drawn(&mut self) -> Result<(), String> {
        let drawn = "new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done(0))))";
        self.browser.evaluate(drawn).map(drop)
    }

    /// Waits until the camera stays where it is.
    pub fn until_still(&mut self) -> Result<(), String> {
        std::thread::sleep(std::time::Duration::from_millis(450));
        self.until_drawn()
    }

    pub fn area(&mut self, selector: &str) -> Result<[f64; 4], String> {
        let expression = format!(
            "(() => {{ const r = document.querySelector({selector:?}).getBoundingClientRect(); \
             return [r.left, r.top, r.width, r.height]; }})()"
        );
        self.browser.numbers(&expression)?.try_into().map_err(|_| format!("{selector} has no area"))
    }

    pub fn text(&mut self, selector: &str) -> Result<String, String> {
        let element = format!("document.querySelector({selector:?})");
        // Drawings have no inner text.
        let text = self.browser.evaluate(&format!("{element}.innerText ?? {element}.textContent"))?;
        text.as_str().map(|t| t.trim().to_owned()).ok_or_else(|| format!("{selector} has no text"))
    }

    /// The text of all plots.
    pub fn text_of_plots(&mut self) -> Result<String, String> {
        Ok([self.text("#plots")?, self.text("#more-plots")?].join("\n"))
    }

    pub fn picture(&mut self, stage: &str) -> Result<(), String> {
        self.capture(stage, false)
    }

    /// The whole page in slices that can be read.
    pub fn slices(&mut self, name: &str) -> Result<(), String> {
        let height = self.browser.numbers("[document.documentElement.scrollHeight]")?[0];
        let mut top = 0.0;
        for number in 1.. {
            let rest = (height - top).min(SLICE);
            if rest <= 0.0 {
                break;
            }
            let clip = json!({"x": 0, "y": top, "width": self.screen.width, "height": rest, "scale": 1});
            let parameters = json!({"format": "png", "captureBeyondViewport": true, "clip": clip});
            let shot = self.browser.call("Page.captureScreenshot", &parameters)?;
            let bytes = STANDARD.decode(shot["data"].as_str().unwrap_or_default()).map_err(|e| e.to_string())?;
            let file = self.pictures.join(format!("{name}-{}-{number}.png", self.screen.name));
            fs::write(&file, bytes).map_err(|e| format!("{}: {e}", file.display()))?;
            top += rest;
        }
        Ok(())
    }

    pub fn capture(&mut self, stage: &str, whole: bool) -> Result<(), String> {
        let shot =
            self.browser.call("Page.captureScreenshot", &json!({"format": "png", "captureBeyondViewport": whole}))?;
        let bytes = STANDARD.decode(shot["data"].as_str().unwrap_or_default()).map_err(|e| e.to_string())?;
        let file = self.pictures.join(format!("{}-{stage}.png", self.screen.name));
        fs::write(&file, bytes).map_err(|e| format!("{}: {e}", file.display()))
    }
}
