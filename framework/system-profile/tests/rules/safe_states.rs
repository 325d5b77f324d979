//! What an actuator's hardware is told while no container runs.

use std::time::Duration;

use system_model::rules::SafeStateRule;

use crate::project::{Project, of};

fn actuator(safe_states: &str) -> String {
    let command = "<command port='command' safe_value='0'/>";
    let text = format!("<actuator stop_category='0'>{command}{safe_states}</actuator>");
    of("motor", &text)
}

#[test]
fn each_device_has_its_bytes_and_its_period() {
    let rules = Project::new()
        .load(&[&actuator(
            "<safe_state device='/dev/ttyUSB0' bytes='02 10 fF' period='50'/>
             <safe_state><device>/dev/ttyS1</device><bytes>00</bytes><period>1s</period></safe_state>",
        )])
        .sound();
    let actuator = &rules.components[4].actuator.as_ref().unwrap().value;
    let state = |device: &str, bytes: &[u8], period| SafeStateRule {
        device: device.to_owned(),
        bytes: bytes.to_owned(),
        period: Duration::from_millis(period),
    };
    assert_eq!(
        actuator.safe_states,
        [
            state("/dev/ttyUSB0", &[0x02, 0x10, 0xff], 50),
            state("/dev/ttyS1", &[0], 1000)
        ]
    );
}

#[test]
fn what_cannot_be_written_is_refused() {
    let too_many = "00 ".repeat(257);
    for (attributes, expected) in [
        (
            "device='simulated:motion_board' bytes='00' period='50'",
            "`simulated:motion_board` is no path of a device",
        ),
        ("bytes='00' period='50'", "<safe_state> has no device"),
        (
            "device='/dev/ttyS1' period='50'",
            "<safe_state> has no bytes",
        ),
        (
            "device='/dev/ttyS1' bytes='00'",
            "<safe_state> has no period",
        ),
        (
            "device='/dev/ttyS1' bytes='00' period='0'",
            "`0` in attribute period of <safe_state> is no time at all",
        ),
        (
            "device='/dev/ttyS1' bytes='' period='50'",
            "<safe_state> has no bytes",
        ),
        (
            "device='/dev/ttyS1' bytes='0x02' period='50'",
            "`0x02` are no bytes",
        ),
        (
            "device='/dev/ttyS1' bytes='+2' period='50'",
            "`+2` are no bytes",
        ),
        (
            &format!("device='/dev/ttyS1' bytes='{too_many}' period='50'"),
            "are no bytes",
        ),
    ] {
        let loaded = Project::new().load(&[&actuator(&format!("<safe_state {attributes}/>"))]);
        assert!(loaded.rules.is_none(), "{attributes}");
        let problems = loaded.problems.join("\n");
        assert!(problems.contains(expected), "{attributes}: {problems}");
    }
}
