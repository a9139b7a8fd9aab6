//! A headless Chromium, driven through the DevTools protocol: just the few commands that the test needs, so that a WebSocket
//! library is all it takes.

use std::io::{BufRead, BufReader};
use std::net::TcpStream;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};
use tungstenite::stream::MaybeTlsStream;
use tungstenite::{Message, WebSocket, connect};

/// How long the browser may take over anything.
const PATIENCE: Duration = Duration::from_secs(60);

/// Names under which the browser is installed.
const NAMES: [&str; 4] = ["chromium", "chromium-browser", "google-chrome-stable", "google-chrome"];

/// The browser's program, if it is installed; the environment's `CHROMIUM` wins.
pub fn installed() -> Option<PathBuf> {
    if let Some(path) = std::env::var_os("CHROMIUM") {
        return Some(path.into());
    }
    let folders = std::env::var_os("PATH")?;
    std::env::split_paths(&folders).flat_map(|f| NAMES.map(|name| f.join(name))).find(|path| path.is_file())
}

/// A running browser with one page.
pub struct Browser {
    process: Child,
    socket: WebSocket<MaybeTlsStream<TcpStream>>,
    session: Option<String>,
    last: u64,
    events: Vec<Value>,
}

impl Browser {
    /// Starts the browser with a profile of its own in the folder `profile`.
    ///
    /// # Errors
    /// The browser cannot be started or does not speak the protocol.
    pub fn start(program: &Path, profile: &Path, more: &[&str]) -> Result<Self, String> {
        let mut process = Command::new(program)
            .args([
                "--headless=new",
                "--no-sandbox",
                "--remote-debugging-port=0",
                "--no-first-run",
                "--hide-scrollbars",
            ])
            .arg(format!("--user-data-dir={}", profile.display()))
            .args(more)
            .stderr(Stdio::piped())
            .stdout(Stdio::null())
            .spawn()
            .map_err(|e| format!("{} cannot be started: {e}", program.display()))?;
        let address = process.stderr.take().and_then(|stderr| {
            let mut lines = BufReader::new(stderr).lines().map_while(Result::ok);
            let address = lines.find_map(|line| line.strip_prefix("DevTools listening on ").map(str::to_owned));
            // A full pipe would stop the browser.
            std::thread::spawn(move || lines.for_each(drop));
            address
        });
        let address = address.ok_or("the browser ended before it could be talked to")?;
        let (socket, _) = connect(&address).map_err(|e| format!("{address}: {e}"))?;
        if let MaybeTlsStream::Plain(stream) = socket.get_ref() {
            stream.set_read_timeout(Some(PATIENCE)).map_err(|e| e.to_string())?;
        }
        let mut browser = Self { process, socket, session: None, last: 0, events: Vec::new() };
        let target = browser.call("Target.createTarget", &json!({"url": "about:blank"}))?;
        let attached = json!({"targetId": target["targetId"], "flatten": true});
        let session = browser.call("Target.attachToTarget", &attached)?;
        browser.session = session["sessionId"].as_str().map(str::to_owned);
        for domain in ["Page", "Runtime", "Network", "Log"] {
            browser.call(&format!("{domain}.enable"), &json!({}))?;
        }
        Ok(browser)
    }

    /// Sends a command and returns its result.
    ///
    /// # Errors
    /// What the browser says is wrong with it, or that it says nothing.
    pub fn call(&mut self, method: &str, parameters: &Value) -> Result<Value, String> {
        self.last += 1;
        let mut command = json!({"id": self.last, "method": method, "params": parameters});
        if let Some(session) = &self.session {
            command["sessionId"] = session.as_str().into();
        }
        self.socket.send(Message::text(command.to_string())).map_err(|e| format!("{method}: {e}"))?;
        loop {
            let message = self.socket.read().map_err(|e| format!("{method}: {e}"))?;
            let Message::Text(text) = message else { continue };
            let mut answer: Value = serde_json::from_str(&text).map_err(|e| format!("{method}: {e}"))?;
            if answer["id"] == self.last {
                return match answer.get("error") {
                    Some(error) => Err(format!("{method}: {}", error["message"])),
                    None => Ok(answer["result"].take()),
                };
            }
            self.events.push(answer);
        }
    }

    /// The value of a JavaScript expression.
    ///
    /// # Errors
    /// An exception of it.
    pub fn evaluate(&mut self, expression: &str) -> Result<Value, String> {
        let parameters = json!({"expression": expression, "returnByValue": true, "awaitPromise": true});
        let mut result = self.call("Runtime.evaluate", &parameters)?;
        match result.get("exceptionDetails") {
            Some(details) => Err(format!("{expression}: {}", details["exception"]["description"])),
            None => Ok(result["result"]["value"].take()),
        }
    }

    /// The numbers of a JavaScript expression that is a list of them.
    ///
    /// # Errors
    /// An exception, or anything but numbers.
    pub fn numbers(&mut self, expression: &str) -> Result<Vec<f64>, String> {
        let value = self.evaluate(expression)?;
        let numbers: Option<Vec<f64>> = value.as_array().and_then(|list| list.iter().map(Value::as_f64).collect());
        numbers.ok_or_else(|| format!("{expression} is {value}, no list of numbers"))
    }

    /// Waits until an expression is true.
    ///
    /// # Errors
    /// It never becomes true.
    pub fn wait_for(&mut self, expression: &str) -> Result<(), String> {
        let began = Instant::now();
        while self.evaluate(&format!("Boolean({expression})"))? != true {
            if began.elapsed() > PATIENCE {
                return Err(format!("{expression} did not become true"));
            }
            std::thread::sleep(Duration::from_millis(30));
        }
        Ok(())
    }

    /// The upper left corner of the page as a PNG file, on a screen of that size and in its own pixels.
    ///
    /// # Errors
    /// The browser's.
    pub fn picture(&mut self, [width, height]: [f64; 2]) -> Result<Vec<u8>, String> {
        let size = json!({"width": width, "height": height, "deviceScaleFactor": 1, "mobile": false});
        self.call("Emulation.setDeviceMetricsOverride", &size)?;
        let shot = self.call("Page.captureScreenshot", &json!({"format": "png"}))?;
        STANDARD.decode(shot["data"].as_str().unwrap_or_default()).map_err(|e| e.to_string())
    }

    /// Presses the left button at the first place, moves along the others with it, and lets it go.
    ///
    /// # Errors
    /// The browser's.
    pub fn drag(&mut self, places: &[[f64; 2]]) -> Result<(), String> {
        let mut event = |kind: &str, [x, y]: [f64; 2], buttons: u32| {
            let parameters =
                json!({"type": kind, "x": x, "y": y, "button": "left", "buttons": buttons, "clickCount": 1});
            self.call("Input.dispatchMouseEvent", &parameters).map(drop)
        };
        let (Some(&first), Some(&last)) = (places.first(), places.last()) else { return Ok(()) };
        event("mouseMoved", first, 0)?;
        event("mousePressed", first, 1)?;
        for &place in &places[1..] {
            event("mouseMoved", place, 1)?;
        }
        event("mouseReleased", last, 0)
    }

    /// Moves the pointer to a place.
    ///
    /// # Errors
    /// The browser's.
    pub fn hover(&mut self, [x, y]: [f64; 2]) -> Result<(), String> {
        self.call("Input.dispatchMouseEvent", &json!({"type": "mouseMoved", "x": x, "y": y})).map(drop)
    }

    /// Turns the wheel at a place, by pixels downwards.
    ///
    /// # Errors
    /// The browser's.
    pub fn wheel(&mut self, [x, y]: [f64; 2], down: f64) -> Result<(), String> {
        let parameters = json!({"type": "mouseWheel", "x": x, "y": y, "deltaX": 0, "deltaY": down});
        self.call("Input.dispatchMouseEvent", &parameters).map(drop)
    }

    /// Chooses a file for an input.
    ///
    /// # Errors
    /// The browser's.
    pub fn choose_file(&mut self, selector: &str, file: &Path) -> Result<(), String> {
        let expression = format!("document.querySelector({selector:?})");
        let found = self.call("Runtime.evaluate", &json!({"expression": expression}))?;
        let parameters = json!({"files": [file.display().to_string()], "objectId": found["result"]["objectId"]});
        self.call("DOM.setFileInputFiles", &parameters).map(drop)
    }

    /// Presses a key, e.g. `ArrowDown`, with what has the focus.
    ///
    /// # Errors
    /// The browser's.
    pub fn key(&mut self, key: &str, code: u32) -> Result<(), String> {
        for kind in ["rawKeyDown", "keyUp"] {
            let parameters = json!({"type": kind, "key": key, "code": key, "windowsVirtualKeyCode": code});
            self.call("Input.dispatchKeyEvent", &parameters)?;
        }
        Ok(())
    }

    /// Writes a text where the focus is.
    ///
    /// # Errors
    /// The browser's.
    pub fn write(&mut self, text: &str) -> Result<(), String> {
        self.call("Input.insertText", &json!({"text": text})).map(drop)
    }

    /// Lets files that a page saves go to a folder.
    ///
    /// # Errors
    /// The browser's.
    pub fn save_into(&mut self, folder: &Path) -> Result<(), String> {
        let parameters = json!({"behavior": "allow", "downloadPath": folder.display().to_string()});
        self.call("Browser.setDownloadBehavior", &parameters).map(drop)
    }

    /// Touches a place with a finger.
    ///
    /// # Errors
    /// The browser's.
    pub fn tap(&mut self, [x, y]: [f64; 2]) -> Result<(), String> {
        self.call("Input.dispatchTouchEvent", &json!({"type": "touchStart", "touchPoints": [{"x": x, "y": y}]}))?;
        self.call("Input.dispatchTouchEvent", &json!({"type": "touchEnd", "touchPoints": []})).map(drop)
    }

    /// Moves a finger along places.
    ///
    /// # Errors
    /// The browser's.
    pub fn swipe(&mut self, places: &[[f64; 2]]) -> Result<(), String> {
        for (number, [x, y]) in places.iter().enumerate() {
            let kind = if number == 0 { "touchStart" } else { "touchMove" };
            let points = json!([{"x": x, "y": y}]);
            self.call("Input.dispatchTouchEvent", &json!({"type": kind, "touchPoints": points}))?;
        }
        self.call("Input.dispatchTouchEvent", &json!({"type": "touchEnd", "touchPoints": []})).map(drop)
    }

    /// What the page said on its console or threw, and what it asked of the network, since the last call.
    ///
    /// # Errors
    /// The browser's.
    pub fn complaints(&mut self) -> Result<Vec<String>, String> {
        // An answer comes after everything that happened before.
        self.evaluate("0")?;
        let complaint = |event: &Value| {
            let parameters = &event["params"];
            match event["method"].as_str()? {
                "Runtime.exceptionThrown" => Some(parameters["exceptionDetails"].to_string()),
                "Log.entryAdded" => Some(parameters["entry"].to_string()),
                "Runtime.consoleAPICalled" => Some(parameters["args"].to_string()),
                "Network.requestWillBeSent" => {
                    let address = parameters["request"]["url"].as_str()?;
                    let is_inside = ["file:", "data:", "blob:", "about:"].iter().any(|own| address.starts_with(own));
                    (!is_inside).then(|| format!("asked for {address}"))
                }
                _ => None,
            }
        };
        Ok(std::mem::take(&mut self.events).iter().filter_map(complaint).collect())
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}
