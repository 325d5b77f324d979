//! The application of a group as its integrator would write it: profiles, rules, and the faults
//! that are made on purpose. One source feeds a chain of relay and sink for each component under
//! test; no component knows what is measured.

use std::fmt::Write as _;
use std::io;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::real_time::PRIORITY;
use super::scenario::{Fault, Group, Handling};

/// Of all components, in milliseconds: 1 kHz.
pub(super) const PERIOD_MS: u64 = 1;

/// How long a callback may take: a period.
pub(super) const CALLBACK_DEADLINE_MS: u64 = 1;

/// A callback in which its host is to be killed, in milliseconds: much longer than it takes until
/// then; and how long it may take, so that nobody else ends it.
const KILLED_CALLBACK_MS: u64 = 20;
const KILLED_DEADLINE_MS: u64 = 100;

/// One callback is so: before its host is killed, and the successor makes good for it, this is over.
const KILLED_WINDOW_US: u64 = 200;

/// Cycles before the first fault: all threads have started, first checkpoints have been taken.
const QUIET_CYCLES: u64 = 50;

/// Checkpoints are as old as in a controller of 100 Hz that takes one every cycle.
const BACKUP_MS: u64 = 10;

/// Resets are forgotten after this, which is shorter than the time between two faults of one
/// component: the budget of resets is never used up.
const FORGOTTEN_MS: u64 = 3;

/// Files of the application.
pub(super) const APPLICATION: &str = "application.xml";
pub(super) const RULES: &str = "rules.xml";
pub(super) const INJECTIONS: &str = "injections.xml";

/// What one process measures.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Batch {
    /// The rows.
    pub(super) group: Group,
    /// Of all processors, which tells how soon there is another standby.
    pub(super) load_percent: u8,
    /// Components under test of each row: between two faults of one the others have theirs.
    pub(super) chains: u32,
    /// Faults of each component.
    pub(super) faults: u32,
}

impl Batch {
    /// Each component under test: its number, and how its faults are handled.
    pub(super) fn relays(&self) -> impl Iterator<Item = (u32, Handling)> + '_ {
        let handlings = (0..self.chains).flat_map(|_| self.group.handlings.iter().copied());
        (0..).zip(handlings)
    }

    /// Writes all files to a folder.
    ///
    /// # Errors
    /// If one cannot be written.
    pub(super) fn write(&self, folder: &Path) -> io::Result<()> {
        let write = |name: &str, text: String| {
            let declaration = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";
            std::fs::write(folder.join(name), format!("{declaration}{text}"))
        };
        write("source.xml", profile("source"))?;
        write("relay.xml", profile("relay"))?;
        for number in 0..self.faults {
            // Each of its own name: a secondary that has failed is not tried again.
            let name = secondary_name(number);
            write(&format!("{name}.xml"), profile(&name))?;
        }
        write("sink.xml", profile("sink"))?;
        write(APPLICATION, self.application())?;
        write(RULES, self.rules())?;
        write(INJECTIONS, self.injections())
    }

    fn application(&self) -> String {
        let mut components = component("source", "source");
        let mut connections = String::new();
        for (number, _) in self.relays() {
            let (relay, sink) = (relay_name(number), sink_name(number));
            components += &component(&relay, "relay");
            components += &component(&sink, "sink");
            connections += &connection("source", &relay);
            connections += &connection(&relay, &sink);
        }
        format!(
            "<package_profile><name>recovery</name>\n<subcomponents>\n{components}</subcomponents>\n\
             <port_connections>\n{connections}</port_connections></package_profile>\n"
        )
    }

    fn rules(&self) -> String {
        let mut rules = String::new();
        for (number, handling) in self.relays() {
            rules += &self.rules_of(&relay_name(number), handling);
            if handling == Handling::EmergencyStop {
                let sink = sink_name(number);
                let _infallible = writeln!(
                    rules,
                    "<component name=\"{sink}\"><actuator stop_category=\"2\">\
                     <command port=\"input\" safe_value=\"0\"/></actuator></component>"
                );
            }
        }
        format!("<fault_rules application=\"recovery\">\n{rules}</fault_rules>\n")
    }

    fn rules_of(&self, relay: &str, handling: Handling) -> String {
        let tier = self.group.tier.name();
        let deadline_ms = match self.group.fault {
            Fault::HostKilled => KILLED_DEADLINE_MS,
            _ => CALLBACK_DEADLINE_MS,
        };
        let stops_at_once =
            handling == Handling::EmergencyStop && self.group.fault == Fault::OutOfRange;
        let severity = if stops_at_once { "emergency" } else { "reset" };
        let backup = match handling {
            Handling::Reset => String::new(),
            _ => format!("<backup>{BACKUP_MS}</backup>"),
        };
        let standby = match handling {
            Handling::StandbyWarm => "<standby preload=\"warm\"/>",
            _ => "",
        };
        let ladder = match (handling, handling.secondary_preload()) {
            (_, Some(preload)) => {
                let secondary = |number| {
                    let name = secondary_name(number);
                    format!(
                        "<secondary preload=\"{preload}\"><reference>{name}.xml</reference></secondary>\n"
                    )
                };
                let secondaries: String = (0..self.faults).map(secondary).collect();
                format!("<fault><retry_max>0</retry_max>\n{secondaries}</fault>")
            }
            // After a clear one reset is made, and the next fault within a minute is one too many.
            (Handling::EmergencyStop, None) => {
                "<fault><retry_max>1</retry_max><severity>global</severity></fault>".to_owned()
            }
            (_, None) => {
                format!("<fault window=\"{FORGOTTEN_MS}ms\"><retry_max>100</retry_max></fault>")
            }
        };
        format!(
            "<component name=\"{relay}\"><isolation>{tier}</isolation>\n\
             <watchdog deadline=\"{deadline_ms}\"/>\n\
             <port name=\"output\"><validity field=\"value\"><min>0</min><max>999</max></validity></port>\n\
             <severity>{severity}</severity>\n\
             <resurrect><reset>true</reset>{backup}</resurrect>{standby}\n{ladder}</component>\n"
        )
    }

    fn cycles(&self, handling: Handling) -> u64 {
        self.group.cycles(handling, self.load_percent)
    }

    /// Faults come one after the other, component by component, round and round.
    fn injections(&self) -> String {
        let every: u64 = self.relays().map(|(_, it)| self.cycles(it)).sum();
        let repeat = self.faults;
        let killed = format!(
            "fault=\"slow\" duration=\"{KILLED_CALLBACK_MS}ms\" for=\"{KILLED_WINDOW_US}us\""
        );
        let what = match self.group.fault {
            Fault::HostKilled => &killed,
            Fault::Trap => "fault=\"segfault\"",
            Fault::Panic => "fault=\"panic\"",
            Fault::Hang => "fault=\"hang\"",
            Fault::ErrorReturn => "fault=\"error_return\" code=\"500\"",
            Fault::OutOfRange => {
                // Less than a period: one datum.
                "fault=\"out_of_range\" port=\"output\" field=\"value\" value=\"5000\" for=\"500us\""
            }
        };
        let mut injections = String::new();
        let mut first = QUIET_CYCLES;
        for (number, handling) in self.relays() {
            let relay = relay_name(number);
            let _infallible = writeln!(
                injections,
                "<inject at_cycle=\"{first}\" every_cycles=\"{every}\" repeat=\"{repeat}\" \
                 component=\"{relay}\" {what}/>"
            );
            first += self.cycles(handling);
        }
        format!("<fault_injections application=\"recovery\">\n{injections}</fault_injections>\n")
    }
}

/// A component under test.
pub(super) fn relay_name(number: u32) -> String {
    format!("relay_{number}")
}

/// Who receives what it passes on.
pub(super) fn sink_name(number: u32) -> String {
    format!("sink_{number}")
}

fn secondary_name(number: u32) -> String {
    format!("secondary_{number}")
}

/// All alike, so that all run on one thread, in document order: a sink takes each datum in the cycle
/// that made it, and what a dead relay had sent is never still under way, to be voided with it.
fn profile(name: &str) -> String {
    let is_source = name == "source";
    format!(
        "<component_profile><name>{name}</name><version>0.1.0</version>\n\
         <execution_environment><library_name>librelay.so</library_name></execution_environment>\n\
         <execution_semantics><type>periodic-shared</type><period>{PERIOD_MS}</period>\
         <priority>{PRIORITY}</priority><policy>SCHED_FIFO</policy></execution_semantics>\n\
         <properties><property name=\"source\" type=\"boolean\">{is_source}</property></properties>\n\
         <ports><data_port><name>input</name><usage>input</usage><data_type>Parcel</data_type>\
         <queueing_policy>FIFO</queueing_policy><queue_size>64</queue_size></data_port>\n\
         <data_port><name>output</name><usage>output</usage><data_type>Parcel</data_type></data_port>\
         </ports></component_profile>\n"
    )
}

fn component(name: &str, profile: &str) -> String {
    format!(
        "<subcomponent><name>{name}</name><reference>{profile}.xml</reference></subcomponent>\n"
    )
}

fn connection(from: &str, to: &str) -> String {
    format!(
        "<port_connection port_type=\"data\"><source component_name=\"{from}\" \
         port_name=\"output\"/><target component_name=\"{to}\" port_name=\"input\"/></port_connection>\n"
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::commands::bench::recovery::batch::load;
    use crate::commands::bench::recovery::plan::batches;
    use crate::commands::bench::recovery::scenario::groups;

    /// The rows of the report are what they say only if the rules are.
    #[test]
    fn every_application_is_read_with_its_rules_and_injections() {
        for group in groups(true) {
            let folder = tempfile::tempdir().expect("a folder");
            let batch = batches(&group, 7, 10).remove(0);
            batch.write(folder.path()).expect("files");
            let application = load(folder.path()).unwrap_or_else(|error| panic!("{error}"));
            let relays = batch.relays().count();
            assert_eq!(application.specification.components.len(), 1 + 2 * relays);
            assert_eq!(application.injections.len(), relays);
            for (number, handling) in batch.relays() {
                let components = &application.specification.components;
                let name = relay_name(number);
                let index = components.iter().position(|it| it.name == name);
                let rules = &application.rules.components[index.expect("the relay")];
                let secondaries = match handling.secondary_preload() {
                    Some(_) => batch.faults as usize,
                    None => 0,
                };
                assert_eq!(rules.secondaries.len(), secondaries, "{name}");
                assert_eq!(
                    rules.standby.is_some(),
                    handling == Handling::StandbyWarm,
                    "{name}"
                );
            }
        }
    }
}
