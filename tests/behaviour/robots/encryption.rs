//! Robots that prove their names by certificates.

#[path = "../../../framework/robot-network/tests/certificates/mod.rs"]
mod certificates;

use super::*;
use crate::migration::{pack, receiver, traveller};
use certificates::Authority;
use system_model::network::NetworkSecurity;

/// `<network>` with these files.
fn secured(
    name: &str,
    listen: u16,
    connect: &[u16],
    security: &NetworkSecurity,
    content: &str,
) -> String {
    let allow = |robot: &String| format!("<allow robot='{robot}'/>");
    let allowed: String = security.allowed.iter().map(allow).collect();
    let content = format!(
        "<tls certificate='{}' private_key='{}' authority='{}'/>{allowed}{content}",
        security.certificate.display(),
        security.private_key.display(),
        security.authority.display()
    );
    network(name, listen, connect, &content).replace("tcp/", "tls/")
}

#[test]
fn robots_that_prove_their_names_work_together_and_others_are_not_there() {
    let _turn = take_turn();
    let (authority, foreign) = (Authority::new("team"), Authority::new("another team"));
    let [one, other, third, fourth, fifth] = std::array::from_fn(|_| free_port());
    let first = authority.security("R1", &["R2", "R4"]);
    let first = counting(&secured("R1", one, &[], &first, OFFER));
    let second = authority.security("R2", &["R1", "R4"]);
    let second = recording(&secured("R2", other, &[one], &second, &from("R1")));
    let clear = counting(&network("R0", third, &[one, other], OFFER));
    let of_others = foreign.security("R4", &["R1", "R2"]);
    let of_others = counting(&secured("R4", fourth, &[one, other], &of_others, OFFER));
    let not_allowed = authority.security("R3", &["R1", "R2"]);
    let not_allowed = counting(&secured("R3", fifth, &[one, other], &not_allowed, OFFER));

    let intruders = [("R0", clear), ("R4", of_others), ("R3", not_allowed)];
    let _intruders: Vec<Watched> = intruders.iter().map(|(_, robot)| start(robot)).collect();
    let (killed, _second) = (start(&first), start(&second));
    wait_for(&second, "R1 decides", 1);
    wait_for_data(&second);
    for (name, intruder) in &intruders {
        wait_for(intruder, &format!("{name} decides"), 1);
        assert_eq!(changes(intruder).len(), 1, "{name} hears of somebody");
    }
    wait_for_data(&second);
    killed.signal(Signal::KILL);
    wait_for(&second, "R1 died", 1);
    wait_for(&second, "R2 decides", 1);
    for robot in [&first, &second] {
        let unknown = |change: &String| !change.starts_with("R1 ") && !change.starts_with("R2 ");
        let unknown: Vec<String> = changes(robot).into_iter().filter(unknown).collect();
        assert_eq!(unknown, [""; 0], "robots that prove no name");
    }
}

#[test]
fn files_that_prove_nothing_are_named_before_anything_starts() {
    let authority = Authority::new("team");
    let good = authority.security("R1", &["R2"]);
    let run = |security: &NetworkSecurity| {
        let robot = counting(&secured("R1", free_port(), &[], security, OFFER));
        robot.run(&["--clock", "real", "--for", "1s"])
    };
    let absent = NetworkSecurity {
        private_key: "R1.secret".into(),
        ..good.clone()
    };
    let words = [
        "`R1.secret` cannot be read",
        "application.xml:",
        "its private key",
    ];
    run(&absent).was_refused(1, &words);
    let nobody = NetworkSecurity {
        allowed: Vec::new(),
        ..good
    };
    run(&nobody).was_refused(1, &["no robot may speak to this one", "<allow robot="]);
    let expired = NetworkSecurity {
        allowed: vec!["R2".to_owned()],
        ..authority.expired("R1")
    };
    run(&expired).was_refused(
        6,
        &["the network cannot be entered", "no robot that trusts"],
    );
    let other = authority.security("R3", &["R2"]);
    run(&other).was_refused(6, &["is the certificate of 'R3', not of 'R1'"]);
}

#[test]
fn a_package_is_fetched_by_whoever_may_ask() {
    let _turn = take_turn();
    let authority = Authority::new("team");
    let port = free_port();
    let security = authority.security("R2", &["workbench"]);
    let robot = secured("R2", port, &[], &security, "");
    let robot = counting(&robot.replace("<network ", "<network packages='.' "));
    let folder = robot.folder();
    let trusted = package(folder, &["key", "signing.key"]);
    std::fs::write(folder.join("trusted"), trusted.stdout).expect("a file");
    let profile = repository().join("profiles/components/relay.xml");
    let profile = profile.to_str().expect("a path");
    let sealed = [
        "seal",
        profile,
        "--key",
        "signing.key",
        "--output",
        "relay.sfp",
    ];
    let sealed = package(folder, &sealed);
    assert_eq!(sealed.code, Some(0), "{sealed}");

    let _robot = start(&robot);
    robot.wait_until(|events| events.contains("run_started"));
    let fetch = |visitor: &str, into: &str| {
        let files = authority.security(visitor, &[]);
        let file = |path: &Path| path.display().to_string();
        let arguments = [
            "fetch relay --from R2 --trust trusted --into",
            into,
            &format!("--connect tls/127.0.0.1:{port} --certificate"),
            &file(&files.certificate),
            "--private-key",
            &file(&files.private_key),
            "--authority",
            &file(&files.authority),
        ]
        .join(" ");
        package(folder, &arguments.split(' ').collect::<Vec<_>>())
    };
    let stranger = fetch("stranger", "nothing");
    assert!(
        stranger.stderr.contains("no robot 'R2' answers"),
        "{stranger}"
    );
    assert!(!folder.join("nothing").exists());
    let taken = fetch("workbench", "taken");
    assert_eq!(taken.code, Some(0), "{taken}");
    assert!(folder.join("taken/librelay.so").exists());
}

/// Whoever asks before the start proves the robot's own name, and is not taken for the robot.
#[test]
fn a_component_is_sent_to_a_robot_that_proves_its_name() {
    let _turn = take_turn();
    let authority = Authority::new("team");
    let (one, other) = (free_port(), free_port());
    let security = authority.security("R2", &["R1"]);
    let network = secured("R2", other, &[], &security, "");
    let sender = Application::new()
        .with(&Member::new("diary", "diary"))
        .with_profile(&traveller())
        .element(&network.replace("<network ", "<network packages='packages' "));
    pack(&sender);
    let _sending = start(&sender);
    sender.wait_until(|events| events.contains("run_started"));
    let security = authority.security("R1", &["R2"]);
    let fetch = "<fetch component='traveller' from='R2' key='team.pub' within='30s'/>";
    let receiver = receiver(&secured("R1", one, &[other], &security, fetch));
    let key = std::fs::read(sender.folder().join("team.pub")).expect("a key");
    receiver.write("team.pub", key);
    let _receiving = start(&receiver);
    receiver.wait_until(|events| events.contains("\"got "));
    wait_for(&sender, "R1 decides", 1);
    let mut lives = changes(&sender);
    lives.retain(|change| change == "R1 appeared" || change == "R1 died");
    assert_eq!(lives, ["R1 appeared"]);
}
