//! The fault rules of a measured chain: none, all kinds that can stand on a component, or standbys.

use std::fmt::Write as _;

use super::application::{Chain, PERIOD_MS, name};

/// What the rules of a chain ask for, of each of its components.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Rules {
    /// Nothing: what a component gets without a word.
    None,
    /// Every kind of detection, and a backup.
    All,
    /// A secondary that is prepared so far.
    Standby(&'static str),
}

impl Rules {
    /// For tables and programs.
    pub(super) fn name(self) -> String {
        match self {
            Self::None => "none".to_owned(),
            Self::All => "all".to_owned(),
            Self::Standby(preload) => format!("standby {preload}"),
        }
    }
}

/// As many periods between two backups as in the rules of the reference robot.
const BACKUP_MS: u32 = 3 * PERIOD_MS;

/// A wheel with its motor, two states, as the data do not behave: so the threshold is out of reach
/// and the arithmetic is that of any model of this size.
pub(super) const MODEL: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<process_model name="wheel">
  <state_space kind="discrete" period_ms="1">
    <a>0.9 0; 0.1 0.9</a>
    <b>0.1; 0</b>
    <c>0 1</c>
  </state_space>
  <noise>
    <process>1e-3 0; 0 1e-3</process>
    <measurement>1</measurement>
  </noise>
  <inputs>
    <input name="value"><case><term field="value"/></case></input>
  </inputs>
</process_model>
"#;

/// The rule file of a chain.
pub(super) fn text(chain: &Chain) -> String {
    let mut text =
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<fault_rules application=\"chain\">\n"
            .to_owned();
    for number in 0..chain.components {
        let name = name(number);
        let rules = match chain.rules {
            Rules::None => String::new(),
            Rules::All => all(),
            Rules::Standby(preload) => standby(preload),
        };
        let _infallible = writeln!(
            text,
            "  <component name=\"{name}\">\n    <isolation>{}</isolation>\n{rules}  </component>",
            chain.tier
        );
        if chain.rules == Rules::All {
            text += &monitor(&name);
        }
    }
    text + "</fault_rules>\n"
}

/// Limits are far from what a sane chain does, even on a machine that is late by a second: what is
/// measured is the looking, not the judging.
fn all() -> String {
    let value = "<validity field=\"value\"><min>0</min><max>1000</max></validity>\
                 <rate_of_change field=\"value\" max=\"1e9\"/><stuck field=\"sequence\" count=\"100\"/>";
    format!(
        "    <port name=\"input\">{value}<freshness max_age=\"30000\" safe_value=\"0\"/></port>\n    \
         <port name=\"output\">{value}</port>\n    \
         <exception signal=\"SIGSEGV\"/>\n    \
         <watchdog deadline=\"10000\"/>\n    \
         <overrun tolerated=\"1000000\" within=\"1000\"/>\n    \
         <heartbeat period=\"10000\" missed=\"3\"/>\n    \
         <memory limit_kb=\"1024\"/>\n    \
         <resurrect><reset>true</reset><backup>{BACKUP_MS}</backup></resurrect>\n    \
         <fault window=\"10s\"><retry_max>2</retry_max><severity>local</severity></fault>\n    \
         <recovery deadline=\"100\"/>\n"
    )
}

fn standby(preload: &str) -> String {
    format!(
        "    <resurrect><reset>true</reset></resurrect>\n    \
         <fault window=\"10s\"><retry_max>2</retry_max>\
         <secondary preload=\"{preload}\"><reference>other_relay.xml</reference></secondary>\
         <severity>local</severity></fault>\n"
    )
}

fn monitor(component: &str) -> String {
    format!(
        "  <monitor name=\"{component}_model\"><process_model model=\"model.xml\" method=\"cusum\" \
         window=\"20\" drift=\"0.002\" threshold=\"1e12\">\
         <input component=\"{component}\" port=\"input\"/>\
         <output component=\"{component}\" port=\"output\" field=\"value\"/>\
         </process_model></monitor>\n"
    )
}
