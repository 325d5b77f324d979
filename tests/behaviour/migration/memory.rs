//! The whole way: a component that a robot lacks is sent to it, and when the adaptation moves its
//! work there it goes on from the memory that it had on the other robot.

use std::time::Duration;

use rustix::process::Signal;
use serde_json::Value;
use tests::{Application, Member, take_turn};

use super::{pack, traveller};
use crate::robots::{free_port, network};

/// R2 does the task, until what its source writes is of no use; R1 could do it, with its own source.
const TASK: &str = "<task_profile name='counting'>
  <resources><resource name='power'/></resources>
  <sub_tasks><sub_task name='count'>
    <component name='source' class='sensor'/><component name='worker' class='computation'/>
  </sub_task></sub_tasks>
  <state_machine initial='counting'><state name='counting'><run sub_task='count'/></state></state_machine>
  <links><link from='source' to='worker'/></links>
  <robots>
    <robot name='R1'><has resource='power' amount='10'/>
      <instance component='source' subcomponent='traveller'><estimate functional='0'/></instance>
      <instance component='worker'>
        <evaluator port='output' field='value' scale='1000000'/>
        <estimate functional='1.4'><with component='source' robot='R2'/></estimate>
        <estimate functional='0'/>
      </instance>
    </robot>
    <robot name='R2'><has resource='power' amount='10'/>
      <instance component='source' subcomponent='traveller'><estimate functional='0'/></instance>
      <instance component='worker'>
        <evaluator port='output' field='value' scale='1000000'/><estimate functional='1.4'/>
      </instance>
    </robot>
  </robots>
  <quality functional_threshold='0.1' non_functional_threshold='0.05'/>
  <generation running='left_out'/>
  <decision confirm='1' dwell='200ms' evaluation_period='10ms' estimation_deadline='2s'
            reconfiguration_deadline='5s'/>
  <running><use component='source' robot='R2'/><use component='worker' robot='R2'/></running>
</task_profile>";

/// Numbers that the recorder has got, with the values that came with them.
fn numbers(events: &str) -> Vec<(u64, f64)> {
    let lines = events.lines().filter_map(|line| {
        let event: Value = serde_json::from_str(line).ok()?;
        let text = event["message"].as_str()?.strip_prefix("got ")?;
        Some(text.to_owned())
    });
    let text: Vec<String> = lines.collect();
    let pairs = text.iter().flat_map(|text| text.split(' '));
    let pairs = pairs.filter_map(|pair| {
        let (number, value) = pair.split_once('=')?;
        Some((number.parse().ok()?, value.parse().ok()?))
    });
    pairs.collect()
}

#[test]
fn a_component_that_was_sent_goes_on_from_its_memory_on_the_other_robot() {
    let _turn = take_turn();
    let (one, other) = (free_port(), free_port());
    let address = format!(
        "<network name='R2' listen='tcp/127.0.0.1:{other}' silence_limit='2s' packages='packages'/>"
    );
    let second = Application::new()
        .with(&traveller())
        .with(&Member::new("worker", "echo"))
        .connect("data", "traveller.output", "worker.input")
        .element(&address)
        .rules("<adapt task='task.xml' robot='R2'/>")
        .injections(
            "<inject at='4s' component='traveller' port='output' field='value' fault='offset' \
             value='1000000000'/>",
        );
    second.write("task.xml", TASK);
    pack(&second);
    let running = second.start(&["--clock", "real"]);
    second.wait_until(|events| events.contains("run_started"));

    let fetch = "<fetch component='traveller' from='R2' key='team.pub'/>";
    let first = Application::new()
        .with_reference("traveller", "traveller.xml")
        .with(&Member::new("worker", "echo"))
        .with(&Member::new("recorder", "recorder").property("verbose", "true"))
        .connect("data", "traveller.output", "worker.input")
        .connect("data", "worker.output", "recorder.input")
        .element(&network("R1", one, &[other], fetch))
        .rules("<adapt task='task.xml' robot='R1'/>");
    first.write("task.xml", TASK);
    let key = std::fs::read(second.folder().join("team.pub")).expect("a key");
    first.write("team.pub", key);
    let receiving = first.start(&["--clock", "real"]);
    first.wait_until(|events| {
        let changed = events.find("\"outcome\":\"changed\"");
        changed.is_some_and(|at| numbers(&events[at..]).len() > 20)
    });
    let events = second.events_so_far();
    let outcome = first.interrupt(receiving).ended_well();
    assert!(outcome.cycles("traveller") > 10, "it counts on R1");
    // On R2 it was ordered to stop: what it has counted there is known.
    assert!(events.contains("\"to\":\"INACTIVE\""), "{events}");
    running.signal(Signal::INT);
    let outcome = second.outcome(running.wait(Duration::from_secs(30)));
    let counted = outcome.ended_well().cycles("traveller");
    let (next, value) = numbers(&first.events_so_far())[0];
    assert!(next > 20, "the count begins anew: {next}");
    assert!(next <= counted + 1, "{next} after {counted}");
    assert!(value < 1e6, "nothing of use: {value}");
}
