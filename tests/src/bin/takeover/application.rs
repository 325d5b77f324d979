//! The application: a source that fails, a recorder behind it, and one that walks over memory, all on
//! one thread every millisecond.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use container::assembly::LibraryOptions;
use container::event_log::Event;
use container::library::LibrarySearch;
use container::recording::RecordingOptions;
use container::status::ComponentStatus;
use container::system::{Application, ClockKind, RunOptions, StateOptions, System};
use crossbeam::channel::{Receiver, bounded};
use system_profile::{LoadOptions, load_application, load_injections, load_rules};
use tests::until;

use super::{Plan, allocations};

/// Of the executor: in the middle of those that profiles have.
pub const PRIORITY: u8 = 50;

/// The first fault comes in this cycle: by then every page that is used without faults was used.
const FIRST_CYCLE: usize = 200;

/// From one fault to the next: on a busy machine it takes some time until there is another standby.
pub const EVERY_CYCLES: usize = 16;

/// One of them.
#[derive(Debug, Clone, Copy)]
pub struct Takeover {
    /// When the component failed, by the container's clock.
    pub at_ns: u64,
    /// From there to its successor's first completed callback.
    pub took_ns: u64,
    /// How often the thread has allocated or freed in that time.
    pub allocations: usize,
}

/// What the run came to.
pub struct Outcome {
    /// By what was taken over, as the verdicts have it.
    pub takeovers: BTreeMap<String, Vec<Takeover>>,
    /// What the recorder said when it was stopped.
    pub received: String,
}

/// Runs the application through all faults.
///
/// # Panics
/// If it does not start, or does not come to the last fault.
pub fn run(plan: &Plan) -> Outcome {
    let folder = tempfile::tempdir().expect("a folder");
    let application = load(folder.path(), plan);
    let (echo, events) = bounded(1 << 20);
    let options = RunOptions {
        clock: ClockKind::Real,
        duration: None,
        seed: 1,
        events: None,
        echo: Some(echo),
        libraries: LibraryOptions {
            search: LibrarySearch::new(vec![plan.libraries.clone()]),
            executable: None,
        },
        state: StateOptions::default(),
        score: None,
        recording: RecordingOptions::default(),
        supervised: None,
        network: None,
    };
    let system = System::start(vec![application], Vec::new(), options).expect("it starts");
    allocations::look_at(thread_named("source"));
    let takeovers = watch(&system, plan.faults);
    let (_summary, _no_file) = system.stop("enough");
    let (notes, received) = told(&events);
    let mut sorted: BTreeMap<String, Vec<Takeover>> = BTreeMap::new();
    for takeover in takeovers {
        // Its verdict is the first one that begins after it.
        let note = notes.range(takeover.at_ns..).next();
        let note = note.map_or_else(|| "unknown".to_owned(), |(_, note)| note.clone());
        sorted.entry(note).or_default().push(takeover);
    }
    Outcome {
        takeovers: sorted,
        received,
    }
}

/// Waits for every takeover.
fn watch(system: &System, faults: usize) -> Vec<Takeover> {
    let status: &Arc<ComponentStatus> = &system.statuses()[0];
    let begin = Instant::now() - system.now();
    let mut takeovers = Vec::new();
    let limit =
        Instant::now() + Duration::from_secs(60) + Duration::from_millis(20) * faults as u32;
    let mut last_ns = 0;
    let enough = (FIRST_CYCLE + EVERY_CYCLES * (faults + 10)) as u64;
    // One that comes while this thread is kept from looking is not counted.
    while status.cycles() < enough && Instant::now() < limit {
        std::thread::sleep(Duration::from_micros(500));
        let (from_ns, to_ns) = (status.misbehaved_ns(), status.works_since_ns());
        if to_ns > from_ns && from_ns > last_ns {
            last_ns = from_ns;
            let at = |ns| begin + Duration::from_nanos(ns);
            takeovers.push(Takeover {
                at_ns: from_ns,
                took_ns: to_ns - from_ns,
                allocations: allocations::between(at(from_ns), at(to_ns)),
            });
        }
    }
    takeovers
}

/// The note of each recovery, by the time of its first symptom, and what the recorder has said last.
fn told(events: &Receiver<(u64, Event)>) -> (BTreeMap<u64, String>, String) {
    let (mut notes, mut received) = (BTreeMap::new(), String::new());
    for (_, event) in events.try_iter() {
        match event {
            Event::Verdict(verdict) => {
                let note = verdict.actions.iter().map(|action| &action.note);
                let note = note.flat_map(|note| note.split(", checkpoint").next());
                notes.insert(verdict.first_symptom_ns, note.collect());
            }
            Event::Log { message, .. } => received = message,
            Event::Notice { message } => eprintln!("{message}"),
            _ => {}
        }
    }
    (notes, received)
}

/// The thread of this name, which may be about to take it.
fn thread_named(name: &str) -> i32 {
    let mut found = None;
    let begun = until(Duration::from_secs(10), || {
        let threads = std::fs::read_dir("/proc/self/task").expect("threads are listed");
        let is_named = |path: &Path| {
            std::fs::read_to_string(path.join("comm")).is_ok_and(|found| found.trim() == name)
        };
        let named = threads
            .filter_map(Result::ok)
            .find(|one| is_named(&one.path()));
        found = named.map(|one| one.file_name());
        found.is_some()
    });
    assert!(begun, "the executor runs");
    let number = found.unwrap_or_default();
    number.to_string_lossy().parse().expect("a number")
}

fn load(folder: &Path, plan: &Plan) -> Application {
    let profile = write_profiles(folder, plan);
    let rules = write(
        folder,
        "rules.xml",
        &format!(
            "<fault_rules application='takeover'><component name='source'>{}</component>\
             </fault_rules>",
            plan.rules
        ),
    );
    let injections = write(
        folder,
        "injections.xml",
        &format!(
            "<fault_injections application='takeover'><inject at_cycle='{FIRST_CYCLE}' \
             repeat='{}' every_cycles='{EVERY_CYCLES}' component='source' fault='{}'/>\
             </fault_injections>",
            plan.faults, plan.fault
        ),
    );
    let options = LoadOptions::default();
    let loaded = load_application(&profile, &options);
    let sound = loaded.specification;
    let specification = sound.unwrap_or_else(|| panic!("{:#?}", loaded.problems));
    let rules = load_rules(&specification, &[rules], &options);
    let injected = load_injections(&specification, &injections);
    let problems = injected.problems;
    Application {
        rules: rules
            .rules
            .unwrap_or_else(|| panic!("{:#?}", rules.problems)),
        models: Vec::new(),
        plans: Vec::new(),
        task: None,
        injections: injected
            .injections
            .unwrap_or_else(|| panic!("{problems:#?}")),
        specification,
    }
}

/// The profiles of the components and of the application, whose path is returned.
fn write_profiles(folder: &Path, plan: &Plan) -> PathBuf {
    let output = "<data_port><name>output</name><usage>output</usage>\
                  <data_type>Sample</data_type></data_port>";
    let input = "<data_port><name>input</name><usage>input</usage><data_type>Sample</data_type>\
                 <queueing_policy>FIFO</queueing_policy><queue_size>100</queue_size></data_port>";
    let mut members = String::new();
    for (name, library, ports, walks_kib) in [
        ("source", "toiler", output, 0),
        ("sink", "recorder", input, 0),
        ("walker", "toiler", output, plan.walks_kib),
    ] {
        let policy = &plan.policy;
        let text = format!(
            "<component_profile><name>{name}</name>\
             <execution_environment><library_name>{library}</library_name></execution_environment>\
             <execution_semantics><type>periodic-shared</type><period>1</period>\
             <priority>{PRIORITY}</priority><policy>{policy}</policy></execution_semantics>\
             <properties><property name='walks_kib'>{walks_kib}</property></properties>\
             <ports>{ports}</ports></component_profile>"
        );
        write(folder, &format!("{name}.xml"), &text);
        members += &format!(
            "<subcomponent><name>{name}</name><reference>{name}.xml</reference></subcomponent>"
        );
    }
    let text = format!(
        "<package_profile><name>takeover</name><subcomponents>{members}</subcomponents>\
         <port_connections><port_connection port_type='data'>\
         <source component_name='source' port_name='output'/>\
         <target component_name='sink' port_name='input'/></port_connection></port_connections>\
         </package_profile>"
    );
    write(folder, "application.xml", &text)
}

fn write(folder: &Path, name: &str, text: &str) -> PathBuf {
    let path = folder.join(name);
    std::fs::write(&path, text).expect("a file is written");
    path
}
