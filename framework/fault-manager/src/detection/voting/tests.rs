//! What sources say and what is voted.

use system_model::rules::Judgement;

use super::*;

const NAN: f64 = f64::NAN;

fn voter(method: VotingMethod, sources: usize) -> Voter {
    let rule = VotingRule {
        of: sources,
        method,
        tolerance: 0.1,
        judgement: Judgement::default(),
    };
    Voter::new(&rule, sources)
}

fn sources(values: &[f64]) -> Vec<SourceValue> {
    let source = |value: &f64| SourceValue {
        value: *value,
        weight: 1.0,
        is_fresh: true,
    };
    values.iter().map(source).collect()
}

/// 'a' agrees, 'd' dissents, '-' silent.
fn opinions(voter: &Voter) -> String {
    let letter = |opinion: &Opinion| match opinion {
        Opinion::Silent => '-',
        Opinion::Agrees => 'a',
        Opinion::Dissents { .. } => 'd',
    };
    voter.opinions().iter().map(letter).collect()
}

#[test]
fn every_method_in_every_situation() {
    use VotingMethod::{Majority, Median, Weighted};
    type Case<'a> = (VotingMethod, &'a [f64], Option<f64>, bool, &'a str);
    let cases: [Case<'_>; 27] = [
        (Median, &[], None, false, ""),
        (Median, &[NAN, NAN], None, false, "--"),
        (Median, &[NAN, 3.0, f64::INFINITY], Some(3.0), true, "-a-"),
        (Median, &[1.05, 1.0], Some(1.05), true, "aa"),
        (Median, &[1.0, 2.0], None, false, "aa"),
        (Median, &[1.0, 0.0, 1.05], Some(1.0), true, "ada"),
        (Median, &[9.0, 1.0, 1.05], Some(1.05), true, "daa"),
        (Median, &[1.0, 2.0, 3.0], Some(2.0), false, "aaa"),
        (Median, &[1.0, 1.05, 9.0, NAN], Some(1.05), true, "aad-"),
        (Median, &[9.0, 1.02, 1.0, 1.05], Some(1.02), true, "daaa"),
        (Majority, &[NAN], None, false, "-"),
        (Majority, &[NAN, 2.0], Some(2.0), true, "-a"),
        (Majority, &[1.0, 1.05], Some(1.025), true, "aa"),
        (Majority, &[1.0, 2.0], None, false, "aa"),
        (Majority, &[1.0, 2.0, 3.0], None, false, "aaa"),
        (Majority, &[0.0, 1.0, 1.05], Some(1.025), true, "daa"),
        (Majority, &[2.0, 2.0, 1.0, 1.0], Some(2.0), true, "aadd"),
        (
            Majority,
            &[1.0, 1.0, 2.0, 2.0, 2.0],
            Some(2.0),
            true,
            "ddaaa",
        ),
        (
            Majority,
            &[f64::MAX, f64::MAX, 1.0],
            Some(f64::MAX),
            true,
            "aad",
        ),
        (Weighted, &[NAN, NAN], None, false, "--"),
        (Weighted, &[NAN, 2.0], Some(2.0), true, "-a"),
        (Weighted, &[1.0, 1.05], Some(1.025), true, "aa"),
        (Weighted, &[1.0, 2.0], None, false, "aa"),
        (Weighted, &[1.0, 2.0, 4.0], None, false, "aaa"),
        (Weighted, &[1.0, 10.0, 1.0], Some(1.0), true, "ada"),
        (Weighted, &[-10.0, 1.0, 1.0, 10.0], Some(1.0), true, "daad"),
        (
            Weighted,
            &[f64::MAX, -f64::MAX, 1.0, 1.0],
            Some(1.0),
            true,
            "ddaa",
        ),
    ];
    for (method, values, value, is_decided, expected) in cases {
        let case = format!("{method:?} {values:?}");
        let mut voter = voter(method, values.len());
        let vote = voter.vote(&sources(values));
        assert_eq!(vote.value, value, "{case}");
        assert_eq!(vote.is_decided, is_decided, "{case}");
        assert_eq!(opinions(&voter), expected, "{case}");
    }
}

#[test]
fn weights_pull_the_mean_and_odd_ones_count_nothing() {
    let cases = [
        ([1.0, 1.0], 1.04),
        ([3.0, 1.0], 1.02),
        ([0.0, 0.0], 1.04),
        ([0.0, 2.0], 1.08),
        ([NAN, 2.0], 1.08),
        ([-5.0, 2.0], 1.08),
        ([f64::INFINITY, 2.0], 1.08),
        ([f64::MAX, f64::MAX], 1.04),
    ];
    for (weights, expected) in cases {
        let mut sources = sources(&[1.0, 1.08]);
        for (source, weight) in sources.iter_mut().zip(weights) {
            source.weight = weight;
        }
        let vote = voter(VotingMethod::Weighted, 2).vote(&sources);
        let value = vote.value.expect("both agree");
        assert!((value - expected).abs() < 1e-12, "{weights:?}: {value}");
    }
}

#[test]
fn stale_sources_are_not_heard_and_dissent_has_a_size() {
    let mut voter = voter(VotingMethod::Median, 4);
    let mut sources = sources(&[9.0, 1.0, 1.0, 4.0]);
    sources[0].is_fresh = false;
    assert_eq!(voter.vote(&sources).value, Some(1.0));
    assert_eq!(opinions(&voter), "-aad");
    assert_eq!(voter.opinions()[3], Opinion::Dissents { difference: 3.0 });
    // Fewer and more sources than there are seats.
    assert_eq!(voter.vote(&sources[1..2]).value, Some(1.0));
    assert_eq!(opinions(&voter), "a---");
    let crowd = [&sources[..], &sources[..]].concat();
    assert_eq!(voter.vote(&crowd).value, Some(1.0));
}
