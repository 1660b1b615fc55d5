//! A headless browser, driven over its debugging pipe, so that tests see a page as its reader does.

use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

/// Browsers that support the protocol.
const BROWSERS: [&str; 4] = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"];

/// Longest time for one answer: drawing without a graphics card takes seconds on a busy machine.
const PATIENCE: Duration = Duration::from_secs(120);

/// The browser on this machine. Without a browser the reason is printed, past the capture of tests; where the
/// environment has `IMPELLERC_BROWSER=required`, this is a failure.
pub(crate) fn find() -> Option<PathBuf> {
    let folders = std::env::var_os("PATH").unwrap_or_default();
    let found =
        std::env::split_paths(&folders).flat_map(|f| BROWSERS.map(|b| f.join(b))).find(|candidate| candidate.is_file());
    if found.is_none() {
        let required = std::env::var("IMPELLERC_BROWSER").is_ok_and(|v| v == "required");
        assert!(!required, "IMPELLERC_BROWSER=required, but none of {BROWSERS:?} is in PATH");
        let reason = format!("skipped: looking at the report needs one of {BROWSERS:?} in PATH\n");
        std::io::stderr().write_all(reason.as_bytes()).unwrap();
    }
    found
}

/// A page in a browser of its own.
pub(crate) struct Page {
    child: Child,
    input: Option<ChildStdin>,
    messages: Receiver<Value>,
    next: u64,
    session: Option<String>,
    /// Addresses that the page requested.
    pub(crate) requests: Vec<String>,
    /// Errors and exceptions on the console.
    pub(crate) complaints: Vec<String>,
}

impl Page {
    /// Opens a file and waits until the page reports that it is drawn.
    pub(crate) fn open(browser: &Path, file: &Path, size: [u32; 2], profile: &Path) -> Self {
        // The browser uses descriptors 3 and 4: the shell connects our pipes to them.
        let script = "exec \"$0\" \"$@\" 3<&0 4>&1 0</dev/null 1>/dev/null 2>/dev/null";
        let mut child = Command::new("sh")
            .args(["-c", script])
            .arg(browser)
            .args(["--headless=new", "--remote-debugging-pipe", "--no-sandbox", "--no-first-run", "--hide-scrollbars"])
            .args(["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-dev-shm-usage"])
            .args(["--disable-background-networking", "--disable-component-update", "--force-color-profile=srgb"])
            .arg(format!("--user-data-dir={}", profile.display()))
            .arg("about:blank")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let input = child.stdin.take();
        let mut output = BufReader::new(child.stdout.take().unwrap());
        let (sender, messages) = channel();
        std::thread::spawn(move || {
            let mut bytes = Vec::new();
            while output.read_until(0, &mut bytes).is_ok_and(|n| n > 0) {
                bytes.pop();
                let Ok(message) = serde_json::from_slice(&bytes) else { break };
                if sender.send(message).is_err() {
                    break;
                }
                bytes.clear();
            }
        });
        let (requests, complaints) = (Vec::new(), Vec::new());
        let mut page = Self { child, input, messages, next: 0, session: None, requests, complaints };
        let target = page.call("Target.createTarget", &json!({ "url": "about:blank" }));
        let attach = json!({ "targetId": target["targetId"], "flatten": true });
        let attached = page.call("Target.attachToTarget", &attach);
        page.session = attached["sessionId"].as_str().map(str::to_owned);
        for domain in ["Page", "Runtime", "Network", "Log"] {
            page.call(&format!("{domain}.enable"), &json!({}));
        }
        let metrics = json!({ "width": size[0], "height": size[1], "deviceScaleFactor": 1, "mobile": false });
        page.call("Emulation.setDeviceMetricsOverride", &metrics);
        let features = [
            json!({ "name": "prefers-reduced-motion", "value": "reduce" }),
            json!({ "name": "prefers-color-scheme", "value": "light" }),
        ];
        page.call("Emulation.setEmulatedMedia", &json!({ "features": features }));
        page.call("Page.navigate", &json!({ "url": format!("file://{}", file.display()) }));
        let start = Instant::now();
        while page.evaluate("document.documentElement?.dataset.drawn || ''") != "yes" {
            assert!(start.elapsed() < PATIENCE, "the page never drew; it said {:?}", page.complaints);
            std::thread::sleep(Duration::from_millis(50));
        }
        page
    }

    /// Sends a command and returns its result.
    fn call(&mut self, method: &str, parameters: &Value) -> Value {
        self.next += 1;
        let id = self.next;
        let mut message = json!({ "id": id, "method": method, "params": parameters });
        if let Some(session) = &self.session {
            message["sessionId"] = json!(session);
        }
        let mut bytes = message.to_string().into_bytes();
        bytes.push(0);
        self.input.as_mut().unwrap().write_all(&bytes).unwrap();
        loop {
            let answer = self.messages.recv_timeout(PATIENCE).unwrap_or_else(|e| panic!("{method}: {e}"));
            if answer["id"] == id {
                assert!(answer["error"].is_null(), "{method}: {}", answer["error"]);
                return answer["result"].clone();
            }
            self.note(&answer);
        }
    }

    /// Keeps the requests and complaints of an event.
    fn note(&mut self, event: &Value) {
        let p = &event["params"];
        match event["method"].as_str() {
            Some("Network.requestWillBeSent") => {
                self.requests.push(p["request"]["url"].as_str().unwrap_or_default().to_owned());
            }
            Some("Runtime.exceptionThrown") => self.complaints.push(p["exceptionDetails"].to_string()),
            Some("Runtime.consoleAPICalled") => self.complaints.push(p["args"].to_string()),
            Some("Log.entryAdded") if p["entry"]["level"] == "error" => self.complaints.push(p["entry"].to_string()),
            _ => {}
        }
    }

    /// Value of an expression as text.
    pub(crate) fn evaluate(&mut self, expression: &str) -> String {
        let result = self.call("Runtime.evaluate", &json!({ "expression": expression, "returnByValue": true }));
        assert!(result["exceptionDetails"].is_null(), "{expression}: {}", result["exceptionDetails"]);
        match &result["result"]["value"] {
            Value::String(text) => text.clone(),
            other => other.to_string(),
        }
    }

    /// Left, top, width and height of the first element of a selector, in pixels of the screenshot.
    pub(crate) fn place(&mut self, selector: &str) -> [usize; 4] {
        let expression = format!(
            "(() => {{ const b = document.querySelector({selector:?}).getBoundingClientRect(); \
             return [b.left, b.top, b.width, b.height].map(Math.round).join(' '); }})()"
        );
        let numbers = self.evaluate(&expression);
        let mut parts = numbers.split(' ').map(|n| n.parse().unwrap_or_else(|_| panic!("{selector} is at {numbers}")));
        std::array::from_fn(|_| parts.next().unwrap())
    }

    /// Clicks with the mouse in the middle of an element and waits for the next picture.
    pub(crate) fn click(&mut self, selector: &str) {
        self.evaluate(&format!("document.querySelector({selector:?}).scrollIntoView({{ block: 'nearest' }})"));
        let [left, top, width, height] = self.place(selector);
        let (x, y) = (left + width / 2, top + height / 2);
        self.mouse("mouseMoved", x, y);
        self.mouse("mousePressed", x, y);
        self.mouse("mouseReleased", x, y);
        self.settle();
    }

    /// One event of the mouse.
    pub(crate) fn mouse(&mut self, kind: &str, x: usize, y: usize) {
        let button = if kind == "mouseMoved" { "none" } else { "left" };
        let event = json!({ "type": kind, "x": x, "y": y, "button": button, "clickCount": 1 });
        self.call("Input.dispatchMouseEvent", &event);
    }

    /// Turns the wheel by pixels at a place; the page scrolls, if it does, before this returns.
    pub(crate) fn wheel(&mut self, [x, y]: [usize; 2], pixels: i32) {
        let event = json!({ "type": "mouseWheel", "x": x, "y": y, "deltaX": 0, "deltaY": pixels });
        self.call("Input.dispatchMouseEvent", &event);
        // A browser may scroll evenly over some frames.
        std::thread::sleep(Duration::from_millis(400));
        self.settle();
    }

    /// Presses a key that has no text, such as `Escape`, or one that writes its own.
    pub(crate) fn key(&mut self, key: &str) {
        let mut event = json!({ "type": "keyDown", "key": key });
        if key.chars().count() == 1 {
            event["text"] = json!(key);
        }
        self.call("Input.dispatchKeyEvent", &event);
        self.call("Input.dispatchKeyEvent", &json!({ "type": "keyUp", "key": key }));
        self.settle();
    }

    /// Fingers on the page, each at its places one after the other.
    pub(crate) fn touch(&mut self, fingers: &[Vec<[usize; 2]>]) {
        self.call("Emulation.setTouchEmulationEnabled", &json!({ "enabled": true, "maxTouchPoints": 2 }));
        let steps = fingers.iter().map(Vec::len).max().unwrap_or(0);
        for step in 0..steps {
            let point = |(id, f): (usize, &Vec<[usize; 2]>)| json!({ "id": id, "x": f[step][0], "y": f[step][1] });
            let points: Vec<Value> = fingers.iter().enumerate().map(point).collect();
            let kind = if step == 0 { "touchStart" } else { "touchMove" };
            self.call("Input.dispatchTouchEvent", &json!({ "type": kind, "touchPoints": points }));
        }
        self.call("Input.dispatchTouchEvent", &json!({ "type": "touchEnd", "touchPoints": [] }));
        self.settle();
    }

    /// Shows the page as it is printed.
    pub(crate) fn as_printed(&mut self) {
        self.call("Emulation.setEmulatedMedia", &json!({ "media": "print" }));
        self.settle();
    }

    /// Waits for two frames: all requested changes are then drawn.
    pub(crate) fn settle(&mut self) {
        let frames = "new Promise(done => requestAnimationFrame(() => requestAnimationFrame(() => done(1))))";
        self.call("Runtime.evaluate", &json!({ "expression": frames, "awaitPromise": true }));
    }

    /// A screenshot of the page, when the picture of the part is the whole one: a slow machine first draws a coarse one.
    pub(crate) fn screenshot(&mut self) -> Picture {
        self.settle();
        let start = Instant::now();
        while self.evaluate("document.documentElement.dataset.picture") == "unfinished" {
            assert!(start.elapsed() < PATIENCE, "the picture is never whole; the page said {:?}", self.complaints);
            std::thread::sleep(Duration::from_millis(20));
        }
        self.settle();
        let result = self.call("Page.captureScreenshot", &json!({ "format": "png" }));
        let bytes = base64(result["data"].as_str().unwrap());
        Picture::from_png(&bytes)
    }
}

impl Drop for Page {
    fn drop(&mut self) {
        // A closed pipe ends the browser; a browser that hangs is killed.
        self.input = None;
        let start = Instant::now();
        while start.elapsed() < Duration::from_secs(5) {
            if self.child.try_wait().is_ok_and(|status| status.is_some()) {
                return;
            }
            std::thread::sleep(Duration::from_millis(50));
        }
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Bytes of a base64 text.
pub(crate) fn base64(text: &str) -> Vec<u8> {
    let digit = |c: u8| match c {
        b'A'..=b'Z' => c - b'A',
        b'a'..=b'z' => c - b'a' + 26,
        b'0'..=b'9' => c - b'0' + 52,
        b'+' => 62,
        b'/' => 63,
        other => panic!("{other} is no digit of base64"),
    };
    let digits: Vec<u8> = text.trim_end_matches('=').bytes().map(digit).collect();
    let mut bytes = Vec::with_capacity(digits.len() * 3 / 4);
    for four in digits.chunks(4) {
        let word = (0..4).fold(0_u32, |w, k| w << 6 | u32::from(four.get(k).copied().unwrap_or(0)));
        bytes.extend_from_slice(&word.to_be_bytes()[1..four.len()]);
    }
    bytes
}

/// Pixels of a screenshot.
pub(crate) struct Picture {
    pub(crate) width: usize,
    pub(crate) height: usize,
    pixels: Vec<[u8; 3]>,
}

impl Picture {
    fn from_png(bytes: &[u8]) -> Self {
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
        let mut data = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut data).unwrap();
        assert_eq!(info.bit_depth, png::BitDepth::Eight);
        let (width, height) = (info.width as usize, info.height as usize);
        let samples = info.color_type.samples();
        assert!(samples >= 3);
        let pixels = data[..info.buffer_size()].chunks(samples).map(|p| [p[0], p[1], p[2]]).collect();
        Self { width, height, pixels }
    }

    /// Pixels of a rectangle: left, top, width, height.
    pub(crate) fn part(&self, [left, top, width, height]: [usize; 4]) -> Vec<[u8; 3]> {
        assert!(left + width <= self.width && top + height <= self.height, "outside of the screenshot");
        (top..top + height)
            .flat_map(|y| self.pixels[y * self.width + left..y * self.width + left + width].iter().copied())
            .collect()
    }
}

/// Number of colours, in steps of 8.
pub(crate) fn colours(pixels: &[[u8; 3]]) -> usize {
    let mut seen: Vec<[u8; 3]> = pixels.iter().map(|p| p.map(|v| v / 8)).collect();
    seen.sort_unstable();
    seen.dedup();
    seen.len()
}

/// Number of pixels within 24 of a colour in each channel.
pub(crate) fn count(pixels: &[[u8; 3]], colour: [u8; 3]) -> usize {
    pixels.iter().filter(|p| p.iter().zip(colour).all(|(a, b)| a.abs_diff(b) <= 24)).count()
}
