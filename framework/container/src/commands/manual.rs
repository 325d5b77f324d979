//! What the commands' help says beyond their options: examples, and how they end.

/// Behind the list of commands.
pub const STEADFAST: &str = "\
A first session:
  steadfast new application patrol  writes two components, rules, and faults to be made on purpose
  cd patrol && ./test.sh            builds, checks and runs all of it
  steadfast check profiles rules    lists every problem of the files, and what to do about it
  steadfast run profiles/applications/patrol.xml --library-path target/debug
                                    runs it until Ctrl-C
  steadfast fault list              says, beside it, what has gone wrong

Exit codes, of all commands:
   0  what was asked for is done
   1  refused: a file has problems, a running application says no, a task cannot be done, or a name
      cannot be used
   2  a file cannot be read or written, there is no terminal, or no running application answers
   3  a library is missing, no component, or for another container
   4  ports or connections do not fit the libraries
   5  a component refused to start, or hung in it
   6  the system refused threads, memory or an address to listen at
   7  the container failed more often than --restarts allows
   8  an order to a running application was tried and failed
   9  an order to a running application was not over in time
  64  the command line is not understood
 130  a second Ctrl-C ended the run at once

Environment:
  STEADFAST_LIBRARY_PATH  folders with component libraries, separated by colons
  STATE_DIRECTORY, XDG_STATE_HOME
                          where checkpoints lie that outlive the container
  NO_COLOR                no colours, wherever the output goes";

/// Of `check`.
pub const CHECK: &str = "\
Examples:
  steadfast check profiles rules
  steadfast check application.xml --strict --search-path ../components
  steadfast check application.xml --format json

Exit codes:
  0  no problem, or warnings only and no --strict
  1  problems
  2  a file cannot be read";

/// Of `run`.
pub const RUN: &str = "\
Examples:
  steadfast run application.xml
  steadfast run application.xml --clock simulated --seed 7 --for 30s --summary summary.json
  steadfast run application.xml --rules rules.xml --inject injections.xml --events events.jsonl
  steadfast run navigation.xml mapping.xml --library-path target/release
  steadfast run application.xml --supervised --restarts 3
  steadfast run application.xml --clock simulated --for 30s --format json > result.json

Exit codes:
    0  the run ended: target reached, duration elapsed, or stopped by Ctrl-C
    1  a profile, world, rule or injection file has problems
    2  a file cannot be read or written
    3  a library is missing, no component, or for another container
    4  ports or connections do not fit the libraries
    5  a component refused to be initialised or started, or hung in it
    6  the system refused threads or memory, or an address to listen at
    7  --supervised: the container failed more often than --restarts allows
  130  a second Ctrl-C ended it at once";

/// Of `replay`.
pub const REPLAY: &str = "\
Examples:
  steadfast replay drive.mcap application.xml --rules rules.xml
  steadfast replay drive.mcap application.xml --component path_planner --output again.mcap
  steadfast replay drive.mcap application.xml --rules rules.xml --format json

Exit codes:
  0  it was replayed to its end, whatever was found
  1  a profile or rule file has problems
  2  a file is no recording, is damaged, or cannot be read or written
  3  a library is missing, no component, or for another container
  4  the recording does not fit the application, or ports do not fit the libraries
  5  the component refused to be initialised or started, or hung in it
  6  the system refused threads or memory";

/// Of `report`.
pub const REPORT: &str = "\
Examples:
  steadfast report events.jsonl --output report.html
  steadfast report events.jsonl drive.mcap --summary summary.json --picture drive.svg --output report.html
  steadfast report monday.jsonl tuesday.jsonl --output both.html --format json

Exit codes:
   0  the page is written
   1  a file is no event file, summary or picture, or has no event in it
   2  a file cannot be read or written, or is a recording that is damaged
  64  more summaries or pictures than runs";

/// Of `fault`.
pub const FAULT: &str = "\
Examples:
  steadfast fault list
  steadfast fault show 3 --format json
  steadfast fault clear --all
  steadfast fault inject '<inject component=\"camera\" fault=\"hang\"/>'

Exit codes:
  0  it was done
  1  the application refused: no such fault, or nothing that can be injected
  2  no application is running, several are, or it does not answer";

/// Of `component`.
pub const COMPONENT: &str = "\
Examples:
  steadfast component list
  steadfast component info camera --format json
  steadfast component reset camera --timeout 30s
  steadfast component replace obstacle_avoidance --with obstacle_avoidance_simple
  steadfast component stop camera

Exit codes:
  0  it was done
  1  the application refused: no such component, or it makes no sense now
  2  no application is running, several are, or it does not answer
  8  it was tried and failed; the rules say what follows
  9  it was not over within --timeout; it goes on";

/// Of `status`.
pub const STATUS: &str = "\
Examples:
  steadfast status
  steadfast status --application target_following --format json

Columns:
  LEVEL  OK; WARN: it works, but is being recovered or has an open fault; ERROR: it should run and
         does not; STALE: it was stopped
  RATE   completed cycles per second, over the last second
  LOAD   how much of its period its executor's cycle takes, over the last second

Exit codes:
  0  it was done
  1  the application refused: too many ask at once
  2  no application is running, several are, or it does not answer";

/// Of `top`.
pub const TOP: &str = "\
Examples:
  steadfast top
  steadfast top --once
  steadfast top --picture top.svg --size 110x30

Keys: arrows choose a component, r resets it, s stops it (asks first), i injects a fault,
c clears a fault, ? helps, q quits. When the application ends, top says so and waits for the next.

Exit codes:
  0  it was left by a key
  1  the application refused: too many ask at once
  2  --once, --picture: no application is running, several are, or it does not answer; there is no
     terminal, or the picture cannot be written";

/// Of `explain`.
pub const EXPLAIN: &str = "\
Examples:
  steadfast explain application.xml --rules rules.xml
  steadfast explain application.xml --rules rules.xml --component camera
  steadfast explain application.xml --rules rules.xml --what-if 'camera segfault'
  steadfast explain application.xml --rules rules.xml --what-if all --format html --output table.html

Exit codes:
  0  explained
  1  a profile or rule file has problems, or the question cannot be understood
  2  a file cannot be read or written";

/// Of `graph`.
pub const GRAPH: &str = "\
Examples:
  steadfast graph application.xml --rules rules.xml --output robot.svg
  steadfast graph application.xml --format dot
  steadfast graph navigation.xml mapping.xml --format mermaid

Exit codes:
  0  drawn
  1  a profile or rule file has problems
  2  a file cannot be read or written";

/// Of `adapt`.
pub const ADAPT: &str = "\
Examples:
  steadfast adapt plan profiles/tasks/visual_servoing_two_robots.xml
  steadfast adapt plan task.xml --format json

Exit codes:
  0  a candidate is chosen, or what runs is kept
  1  the file has problems, or no candidate is feasible
  2  the file cannot be read, or the output cannot be written";

/// Of `package`.
pub const PACKAGE: &str = "\
Examples:
  steadfast package key signing.key > trusted.keys
  steadfast package seal software_dehazer.xml --key signing.key --output software_dehazer.sfp
  steadfast package open software_dehazer.sfp --trust trusted.keys --into components
  steadfast package fetch software_dehazer --from R2 --connect tcp/192.168.0.2:7447 --trust trusted.keys --into components

Exit codes:
  0  done
  1  refused: not signed by a trusted key, cut short, tampered with, for another machine
  2  a file cannot be read or written, or the robot does not answer
  3  the library is not found
  6  the network cannot be entered";

/// Of `bench`.
pub const BENCH: &str = "\
Examples:
  steadfast bench recovery --quick
  steadfast bench overhead --picture overhead.svg
  steadfast bench detection --format json

Exit codes:
  0  measured
  1  the model has problems
  2  a run failed, or a file cannot be written";

/// Of `tree`.
pub const TREE: &str = "\
Examples:
  steadfast tree check navigate.xml --models nav2_tree_nodes.xml
  steadfast tree check trees/*.xml --stubs --format json
  steadfast tree show navigate.xml --stubs --format mermaid
  steadfast tree run navigate.xml --stubs --ticks 20 --answer IsStuck=FAILURE
  steadfast tree run mission.xml --stubs --tree Search --answer Approach=FAILURE:500
  steadfast tree log events.jsonl --format mermaid

Exit codes:
  0  no problem, or warnings only and no --strict; the tree is shown, or was ticked
  1  problems: of a file, or of a script or a port in a tick; an event file without a tree
  2  a file cannot be read";

/// Of `schema`.
pub const SCHEMA: &str = "\
Examples:
  steadfast schema
  steadfast schema steadfast > steadfast.xsd
  steadfast schema fault-rules > fault-rules.xsd

In Visual Studio Code, with the extension XML by Red Hat, settings.json:
  \"xml.fileAssociations\": [{\"pattern\": \"**/*.xml\", \"systemId\": \"steadfast.xsd\"}]

In any editor that knows it, behind the XML declaration of a file:
  <?xml-model href=\"steadfast.xsd\"?>

Exit codes:
  0  printed
  2  the output cannot be written";

/// Of `new`.
pub const NEW: &str = "\
Examples:
  steadfast new component thermometer
  steadfast new component low_pass --language c
  steadfast new application greenhouse --sdk ~/steadfast

Exit codes:
  0  the project is written
  1  the name cannot be used, or its folder is there already
  2  the SDK is not found, or a file cannot be written";

/// Of `completions`.
pub const COMPLETIONS: &str = "\
Examples:
  steadfast completions bash > ~/.local/share/bash-completion/completions/steadfast
  steadfast completions zsh > ~/.zfunc/_steadfast
  steadfast completions fish > ~/.config/fish/completions/steadfast.fish

Exit codes:
  0  printed
  2  the output cannot be written";

/// Of `man`.
pub const MAN: &str = "\
Examples:
  steadfast man --output ~/.local/share/man/man1
  steadfast man > steadfast.1

Exit codes:
  0  written
  2  a page cannot be written";
