//! Chromium without a window, over its debugging protocol.
//!
//! The protocol is spoken over two pipes (`--remote-debugging-pipe`: messages in JSON, each ended by a zero byte),
//! which takes no port, no WebSocket and no library. The browser expects them as descriptors 3 and 4; a shell puts them
//! there.

use anyhow::{Context, Result, anyhow, bail};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

/// How long an answer may take. A page of a large scene needs seconds for its first picture where others are at work as
/// well.
const PATIENCE: Duration = Duration::from_secs(120);

/// Puts the pipes where the browser expects them.
const PIPES: &str = "exec \"$0\" \"$@\" 3<&0 4>&1 0</dev/null 1>/dev/null 2>/dev/null";

/// A running browser with one page.
pub struct Browser {
    child: Child,
    to: ChildStdin,
    from: Receiver<Value>,
    next: u64,
    session: Option<String>,
    /// Messages of the page that no page should give: exceptions, errors on the console, refused or attempted loads.
    pub complaints: Vec<String>,
}

impl Browser {
    /// Starts `chromium` with its profile in `folder`.
    pub fn start(folder: &Path) -> Result<Browser> {
        let profile = format!("--user-data-dir={}", folder.display());
        let options = [
            "--headless",
            "--no-sandbox",
            "--disable-gpu",
            "--hide-scrollbars",
            "--no-first-run",
            // Nothing is looked up or fetched beside the page.
            "--disable-background-networking",
            "--disable-component-update",
            "--disable-sync",
            "--disable-extensions",
            "--remote-debugging-pipe",
        ];
        let mut child = Command::new("sh")
            .args(["-c", PIPES, "chromium"])
            .args(options)
            .arg(profile)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .context("cannot start a shell for chromium")?;
        let to = child.stdin.take().context("no pipe to chromium")?;
        let out = child.stdout.take().context("no pipe from chromium")?;
        let (sender, from) = channel();
        std::thread::spawn(move || {
            for message in BufReader::new(out).split(0).map_while(Result::ok) {
                let parsed = serde_json::from_slice(&message).unwrap_or(Value::Null);
                if sender.send(parsed).is_err() {
                    break;
                }
            }
        });
        let mut browser = Browser {
            child,
            to,
            from,
            next: 0,
            session: None,
            complaints: Vec::new(),
        };
        browser.attach()?;
        Ok(browser)
    }

    fn attach(&mut self) -> Result<()> {
        let made = self.call("Target.createTarget", json!({"url": "about:blank"}))?;
        let target = json!({"targetId": made["targetId"], "flatten": true});
        let attached = self.call("Target.attachToTarget", target)?;
        self.session = attached["sessionId"].as_str().map(str::to_owned);
        for domain in ["Page", "Runtime", "Log", "Network"] {
            self.call(&format!("{domain}.enable"), json!({}))?;
        }
        Ok(())
    }

    /// One command of the protocol and its result.
    pub fn call(&mut self, method: &str, parameters: Value) -> Result<Value> {
        self.next += 1;
        let id = self.next;
        let mut message = json!({"id": id, "method": method, "params": parameters});
        if let Some(session) = &self.session {
            message["sessionId"] = json!(session);
        }
        let mut bytes = message.to_string().into_bytes();
        bytes.push(0);
        let taken = self.to.write_all(&bytes);
        taken.with_context(|| format!("chromium does not take {method}: is it running?"))?;
        let until = Instant::now() + PATIENCE;
        loop {
            let left = until.saturating_duration_since(Instant::now());
            let answer = self.from.recv_timeout(left);
            let answer = answer.with_context(|| format!("chromium gives no answer to {method}"))?;
            if answer["id"] == json!(id) {
                return match answer.get("error") {
                    Some(error) => Err(anyhow!("{method}: {error}")),
                    None => Ok(answer["result"].clone()),
                };
            }
            self.note(&answer);
        }
    }

    /// Keeps what an event complains of.
    fn note(&mut self, event: &Value) {
        let of = &event["params"];
        let complaint = match event["method"].as_str().unwrap_or_default() {
            "Runtime.exceptionThrown" => Some(of["exceptionDetails"].to_string()),
            "Runtime.consoleAPICalled" if of["type"] == "error" => Some(of["args"].to_string()),
            "Log.entryAdded" if of["entry"]["level"] == "error" => Some(of["entry"].to_string()),
            "Network.requestWillBeSent" => {
                let address = of["request"]["url"].as_str().unwrap_or_default();
                let local = ["file:", "data:", "blob:", "about:"];
                let is_local = local.iter().any(|scheme| address.starts_with(scheme));
                (!is_local).then(|| format!("asks for {address}"))
            }
            _ => None,
        };
        self.complaints.extend(complaint);
    }

    /// A screen of this size in CSS pixels, in light or dark.
    pub fn screen(&mut self, width: u32, height: u32, dark: bool) -> Result<()> {
        self.call(
            "Emulation.setDeviceMetricsOverride",
            json!({"width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 700}),
        )?;
        let scheme = if dark { "dark" } else { "light" };
        let features = json!([{"name": "prefers-color-scheme", "value": scheme}]);
        self.call("Emulation.setEmulatedMedia", json!({"features": features}))?;
        Ok(())
    }

    /// Opens a file and waits until `ready`, an expression, holds.
    pub fn open(&mut self, file: &Path, ready: &str) -> Result<()> {
        let file = file.canonicalize()?;
        let address = format!("file://{}", file.display());
        self.call("Page.navigate", json!({"url": address}))?;
        self.wait(ready)
    }

    /// Waits until an expression holds.
    pub fn wait(&mut self, condition: &str) -> Result<()> {
        let until = Instant::now() + PATIENCE;
        while Instant::now() < until {
            let expression = format!("!!({condition})");
            if self.evaluate(&expression).is_ok_and(|value| value == true) {
                return Ok(());
            }
            std::thread::sleep(Duration::from_millis(50));
        }
        bail!("{condition} does not come true; {:?}", self.complaints)
    }

    /// The value of an expression, or of the promise that it gives.
    pub fn evaluate(&mut self, expression: &str) -> Result<Value> {
        let parameters =
            json!({"expression": expression, "returnByValue": true, "awaitPromise": true});
        let answer = self.call("Runtime.evaluate", parameters)?;
        match answer.get("exceptionDetails") {
            Some(details) => bail!("{expression}: {details}"),
            None => Ok(answer["result"]["value"].clone()),
        }
    }

    /// The same as a number.
    pub fn number(&mut self, expression: &str) -> Result<f64> {
        let value = self.evaluate(expression)?;
        let number = value.as_f64();
        number.with_context(|| format!("{expression} is {value} and no number"))
    }

    /// The same as text.
    pub fn text(&mut self, expression: &str) -> Result<String> {
        let value = self.evaluate(expression)?;
        let text = value.as_str().map(str::to_owned);
        text.with_context(|| format!("{expression} is {value} and no text"))
    }

    /// The text of the first element that a selector finds.
    pub fn said(&mut self, selector: &str) -> Result<String> {
        self.text(&format!("document.querySelector({selector:?}).textContent"))
    }

    /// How many elements a selector finds.
    pub fn count(&mut self, selector: &str) -> Result<f64> {
        self.number(&format!("document.querySelectorAll({selector:?}).length"))
    }

    /// Clicks on the first element that a selector finds.
    pub fn click(&mut self, selector: &str) -> Result<Value> {
        self.evaluate(&format!("document.querySelector({selector:?}).click()"))
    }

    /// Gives the first element that a selector finds a value, an expression in which it is called `e`, and tells its
    /// listeners by an event.
    pub fn choose(&mut self, selector: &str, value: &str, event: &str) -> Result<Value> {
        self.evaluate(&format!(
            "(() => {{ const e = document.querySelector({selector:?}); e.value = {value}; \
             e.dispatchEvent(new Event('{event}')); }})()"
        ))
    }

    /// The mouse at a place in CSS pixels; `kind` is mouseMoved, mousePressed or mouseReleased.
    pub fn mouse(&mut self, kind: &str, [x, y]: [f64; 2], pressed: bool) -> Result<()> {
        let (button, buttons) = if pressed { ("left", 1) } else { ("none", 0) };
        let event = json!({"type": kind, "x": x, "y": y, "button": button, "buttons": buttons, "clickCount": 1});
        self.call("Input.dispatchMouseEvent", event)?;
        Ok(())
    }

    /// Places of the mouse one after the other with the button held.
    pub fn drag(&mut self, places: &[[f64; 2]]) -> Result<()> {
        let (Some(first), Some(last)) = (places.first(), places.last()) else {
            return Ok(());
        };
        self.mouse("mouseMoved", *first, false)?;
        self.mouse("mousePressed", *first, true)?;
        for place in places {
            self.mouse("mouseMoved", *place, true)?;
        }
        self.mouse("mouseReleased", *last, true)
    }

    /// The middle of the first element that a selector finds, after scrolling to it.
    pub fn middle(&mut self, selector: &str) -> Result<[f64; 2]> {
        let found = self.evaluate(&format!(
            "(() => {{ const e = document.querySelector({selector:?}); e.scrollIntoView({{block: 'center'}}); \
             const b = e.getBoundingClientRect(); return [b.left + b.width / 2, b.top + b.height / 2]; }})()"
        ))?;
        let at = |i: usize| found[i].as_f64().context("no place");
        Ok([at(0)?, at(1)?])
    }

    /// The whole page as PNG.
    pub fn screenshot(&mut self, file: &Path) -> Result<()> {
        let parameters = json!({"format": "png", "captureBeyondViewport": true});
        let answer = self.call("Page.captureScreenshot", parameters)?;
        let data = answer["data"].as_str().context("no screenshot")?;
        std::fs::write(file, STANDARD.decode(data)?)?;
        Ok(())
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        // The shell has become the browser: this ends it, and its other processes end with their pipe.
        let _ = self.call("Browser.close", json!({}));
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
