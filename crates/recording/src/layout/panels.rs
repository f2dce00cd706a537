//! Panels of a layout, as JSON in the classic format of Foxglove, which Lichtblick reads, too.

use serde_json::{Map, Value, json};

/// A panel: its id, and its state.
pub type Panel = (&'static str, Value);

/// The x axis of a plot.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Axis {
    /// Time, in step with the playback.
    Time,
    /// The number of the episode of each message.
    Episode,
    /// The numbers of the episodes in the last message with a learning curve.
    Curve,
}

/// A curve: the path of its value, its label and its colour.
pub type Curve = (&'static str, &'static str, &'static str);

/// A plot.
pub struct Plot<'a> {
    /// The id after `Plot!`.
    pub id: &'static str,
    /// The title.
    pub title: &'static str,
    /// The x axis.
    pub x: Axis,
    /// The curves.
    pub curves: &'a [Curve],
    /// The width of the legend in pixels.
    pub legend: u32,
    /// True if the legend shows the present values.
    pub values: bool,
}

impl Plot<'_> {
    /// Returns the panel.
    pub fn panel(&self) -> Panel {
        let curves = self.curves.iter();
        let paths = curves.map(|&(value, label, color)| curve(value, label, color));
        let mut state = json!({
            "paths": paths.collect::<Vec<_>>(),
            "showXAxisLabels": true,
            "showYAxisLabels": true,
            "showLegend": self.curves.len() > 1,
            "legendDisplay": "left",
            "showPlotValuesInLegend": self.values,
            "isSynced": self.x == Axis::Time,
            "sidebarDimension": self.legend,
        });
        let (kind, path) = match self.x {
            Axis::Time => ("timestamp", None),
            // Lichtblick of 2026 draws nothing if both axes have the same topic.
            Axis::Episode => ("custom", Some("/begin.episode")),
            Axis::Curve => ("currentCustom", Some("/curve.episode[:]")),
        };
        state["xAxisVal"] = json!(kind);
        if let Some(path) = path {
            state["xAxisPath"] = json!({ "value": path, "enabled": true });
            state["xAxisLabel"] = json!("episode");
        }
        (self.id, titled(self.title, state))
    }
}

/// Returns a curve of a plot.
pub fn curve(value: &str, label: &str, color: &str) -> Value {
    json!({
        "value": value,
        "label": label,
        "color": color,
        "enabled": true,
        "lineSize": 1.5,
        "timestampMethod": "receiveTime",
    })
}

/// Returns a 3D panel with these topics, seen from above.
pub fn scene(title: &str, topics: &[&str]) -> Panel {
    let shown = topics
        .iter()
        .map(|&topic| (topic.to_owned(), json!({ "visible": true })));
    let mut shown: Map<String, Value> = shown.collect();
    shown.insert(
        "/values".to_owned(),
        values("rank", ["#5aa9ff00", "#5aa9ffc8"]),
    );
    let state = json!({
        "cameraState": { "perspective": true, "phi": 30, "thetaOffset": 0, "fovy": 45 },
        "followMode": "follow-none",
        "followTf": "grid",
        "scene": {
            "transforms": {
                "showLabel": false, "axisScale": 0, "lineWidth": 0, "enablePreloading": true
            },
            "backgroundColor": "#161a22",
        },
        "topics": shown,
    });
    ("3D!main", titled(title, state))
}

/// Returns how `/values` is coloured: by a field, from its least to its greatest value.
pub fn values(field: &str, gradient: [&str; 2]) -> Value {
    json!({
        "visible": true,
        "colorMode": "gradient",
        "colorField": field,
        "gradient": gradient,
        "minValue": 0,
        "maxValue": 1,
    })
}

/// Returns a panel with a row of states for each path and label.
pub fn states(id: &'static str, title: &str, paths: &[(&str, &str)]) -> Panel {
    let path = |&(value, label): &(&str, &str)| {
        json!({
            "value": value, "label": label, "enabled": true, "timestampMethod": "receiveTime"
        })
    };
    let paths: Vec<Value> = paths.iter().map(path).collect();
    (
        id,
        titled(title, json!({ "isSynced": true, "paths": paths })),
    )
}

/// Returns a light with a label and a colour for each value of a path. `none` is the label before the
/// first message, with its colour.
pub fn indicator(
    id: &'static str,
    title: &str,
    path: &str,
    none: [&str; 2],
    values: &[[&str; 3]],
) -> Panel {
    let rule = |[value, label, color]: &[&str; 3]| json!({ "operator": "=", "rawValue": value, "color": color, "label": label });
    let state = json!({
        "path": path,
        "style": "background",
        "fallbackLabel": none[0],
        "fallbackColor": none[1],
        "rules": values.iter().map(rule).collect::<Vec<_>>(),
    });
    (id, titled(title, state))
}

/// Returns a gauge from 0 to `most`.
pub fn gauge(id: &'static str, title: &str, path: &str, most: f64, mode: &str) -> Panel {
    let state = json!({
        "path": path,
        "minValue": 0,
        "maxValue": most,
        "colorMap": "red-yellow-green",
        "colorMode": mode,
        "gradient": ["#4e98e2", "#f5774d"],
        "reverse": false,
    });
    (id, titled(title, state))
}

/// Returns a panel with the lines of `/log`.
pub fn log() -> Panel {
    let state = json!({ "searchTerms": [], "minLogLevel": 2, "topicToRender": "/log" });
    ("RosOut!log", titled("Log", state))
}

/// Returns a panel with the last message of a topic.
pub fn raw(id: &'static str, title: &str, topic: &str) -> Panel {
    (
        id,
        titled(title, json!({ "diffEnabled": false, "topicPath": topic })),
    )
}

/// Sets the title of a panel.
pub fn titled(title: &str, mut panel: Value) -> Value {
    for key in ["foxglovePanelTitle", "lichtblickPanelTitle"] {
        panel[key] = json!(title);
    }
    panel
}

/// Returns two panels or groups of panels side by side; the first takes this percentage of the width.
pub fn row(percent: u32, first: impl Into<Value>, second: impl Into<Value>) -> Value {
    split("row", percent, first.into(), second.into())
}

/// Returns two panels or groups of panels, the first above the second.
pub fn column(percent: u32, first: impl Into<Value>, second: impl Into<Value>) -> Value {
    split("column", percent, first.into(), second.into())
}

fn split(direction: &str, percent: u32, first: Value, second: Value) -> Value {
    json!({
        "direction": direction, "splitPercentage": percent, "first": first, "second": second
    })
}
