//! Good packages, and every way in which one is not good.

use super::*;

fn key(first: u8) -> SigningKey {
    let mut secret = [7; 32];
    secret[0] = first;
    SigningKey::from_bytes(&secret)
}

fn trusted(key: &SigningKey) -> TrustedKeys {
    TrustedKeys::parse(&key.public()).expect("a key")
}

fn machine(architecture: &str, abi: u32) -> Machine {
    Machine {
        architecture: architecture.to_owned(),
        abi,
    }
}

fn here() -> Machine {
    machine("x86_64-linux", 3)
}

fn package() -> Package {
    let library = b"\x7fELF of a dehazer".to_vec();
    let profile = b"<component_profile/>".to_vec();
    Package::new(("software_dehazer", "0.1.0"), &here(), library, profile)
}

#[test]
fn a_good_package_arrives_as_it_was_sent() {
    let bytes = package().seal(&key(1)).expect("a package");
    let opened = Package::open(&bytes, &trusted(&key(1)), &here());
    assert_eq!(opened, Ok(package()));
}

#[test]
fn every_bad_package_is_refused_by_name() {
    let good = package().seal(&key(1)).expect("a package");
    let length = good.len();
    let changed = |at: usize| {
        let mut bytes = good.clone();
        bytes[at] ^= 1;
        bytes
    };
    let longer = [&good[..], b"x"].concat();
    let cases = [
        (vec![], "no package"),
        (b"ELF!".to_vec(), "no package"),
        (good[..10].to_vec(), "cut short: 10 bytes of 72"),
        (good[..100].to_vec(), "cut short: 100 bytes of"),
        (good[..length - 1].to_vec(), "cut short: 36 bytes of 37"),
        (longer, "too large"),
        (changed(9), "no key that this robot trusts"),
        (changed(80), "no key that this robot trusts"),
        (changed(length - 21), "library was tampered with"),
        (changed(length - 1), "profile was tampered with"),
    ];
    for (bytes, words) in cases {
        let refusal = Package::open(&bytes, &trusted(&key(1)), &here());
        let refusal = refusal.expect_err(words).to_string();
        assert!(refusal.contains(words), "'{refusal}' has no '{words}'");
    }
}

#[test]
fn strangers_and_other_machines_are_refused() {
    let bytes = package().seal(&key(1)).expect("a package");
    let open = |key: &SigningKey, machine: &Machine| {
        let refusal = Package::open(&bytes, &trusted(key), machine);
        refusal.expect_err("a stranger").to_string()
    };
    assert!(open(&key(2), &here()).contains("no key that this robot trusts"));
    let foreign = open(&key(1), &machine("aarch64-linux", 3));
    assert!(foreign.contains("built for x86_64-linux, this robot is aarch64-linux"));
    assert!(open(&key(1), &machine("x86_64-linux", 4)).contains("version 3 of the ABI"));
}

/// Whatever single bit is wrong anywhere: nothing of it is taken.
#[test]
fn no_bit_of_a_package_can_be_changed() {
    let good = package().seal(&key(1)).expect("a package");
    for at in 0..good.len() {
        let mut bytes = good.clone();
        bytes[at] ^= 1 << (at % 8);
        assert!(
            Package::open(&bytes, &trusted(&key(1)), &here()).is_err(),
            "byte {at}"
        );
    }
}

#[test]
fn keys_are_written_as_digits() {
    let public = key(1).public();
    let two = format!(
        "# of the base station\n{public}\n\n  {}  \n",
        key(2).public()
    );
    let both = TrustedKeys::parse(&two).expect("two keys");
    for number in [1, 2] {
        let bytes = package().seal(&key(number)).expect("a package");
        assert!(Package::open(&bytes, &both, &here()).is_ok());
    }
    let no_point = format!("02{}", "00".repeat(31));
    for (text, words) in [
        ("", "no key in it"),
        ("# nothing\n", "no key in it"),
        ("12ab", "line 1 is no key"),
        (
            &format!("{public}\n{}", "+1".repeat(32)),
            "line 2 is no key",
        ),
        (&no_point, "no public key"),
        (&format!("{public}\n").repeat(65), "more than 64"),
    ] {
        let error = TrustedKeys::parse(text).expect_err(words).to_string();
        assert!(error.contains(words), "'{error}' has no '{words}'");
    }
    let secret = "07".repeat(32);
    let parsed = SigningKey::parse(&format!("# secret\n{secret}\n")).expect("a key");
    assert_eq!(parsed.public(), key(7).public());
    assert!(SigningKey::parse(&format!("{secret}\n{secret}")).is_err());
}
