//! Files that an experiment names go wherever the experiment goes.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

use hwasp_training::collect::ExperimentText;

/// Requests to other machines had the text alone; a model beside it would have been missing there.
#[test]
fn a_request_brings_the_files_along() {
    let written = r#"{"text":"name = \"x\"","files":{"m/robot.xml":"3c6d2f3e"}}"#;
    let text: ExperimentText = serde_json::from_str(written).unwrap();
    assert_eq!(serde_json::to_string(&text).unwrap(), written);
    assert_eq!(text.as_str(), "name = \"x\"");
    let alone = ExperimentText::from("name = \"x\"".to_owned());
    assert_eq!(serde_json::to_string(&alone).unwrap(), r#"{"text":"name = \"x\""}"#);
    assert!(text != alone);
}
