//! How the faults of all rows are spread over processes.

use super::application::Batch;
use super::scenario::{Fault, Group, Handling, Tier};

/// Components under test of each row. Their faults take turns, so that each has time to get another
/// standby while the others are hit.
const CHAINS: u32 = 5;

/// Faults of one component in one process. A secondary is used once, so this many stand in its
/// rules; every fault may leave an instance and a copy of the library behind, 300 KB or so.
const FAULTS: u32 = 50;

/// The same in the tier `process`: each of them takes a wake of its host in every cycle, and a fault
/// leaves nothing behind.
const PROCESS_CHAINS: u32 = 2;
const PROCESS_FAULTS: u32 = 100;

/// Emergency stops in one process.
const STOPS: u32 = 500;

/// One fault in so many more where data are bad: now and then one falls into a recovery that is not
/// over, and is no fault of its own.
const IN_A_RECOVERY: u32 = 100;

/// Processes that together measure `n` faults of each row of a group beside a load.
pub(super) fn batches(group: &Group, n: u32, load_percent: u8) -> Vec<Batch> {
    let stops = group.handlings.contains(&Handling::EmergencyStop);
    let (chains, most) = match group.tier {
        _ if stops => (1, STOPS),
        Tier::Guarded => (CHAINS, FAULTS),
        Tier::Process => (PROCESS_CHAINS, PROCESS_FAULTS),
    };
    let mut left = match group.fault {
        Fault::OutOfRange => n + n.div_ceil(IN_A_RECOVERY),
        _ => n,
    };
    let mut batches = Vec::new();
    while left > 0 {
        let faults = left.div_ceil(chains).min(most);
        // The first of a component's emergencies may be a reset that is within its budget.
        let in_vain = u32::from(stops);
        batches.push(Batch {
            load_percent,
            group: group.clone(),
            chains,
            faults: faults + in_vain,
        });
        left = left.saturating_sub(faults * chains);
    }
    batches
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::commands::bench::recovery::scenario::groups;

    #[test]
    fn every_row_gets_its_faults_and_no_process_too_many() {
        for group in groups(true) {
            for n in [1, 19, 20, 200, 201, 1000, 5000] {
                let batches = batches(&group, n, 80);
                let faults: u32 = batches.iter().map(|it| it.chains * it.faults).sum();
                assert!(faults >= n, "{group:?}, {n}: {faults}");
                assert!(
                    faults <= n + n / IN_A_RECOVERY + CHAINS + 10,
                    "{group:?}, {n}: {faults}"
                );
                let most = |it: &Batch| it.faults <= PROCESS_FAULTS.max(STOPS + 1);
                assert!(batches.iter().all(most), "{group:?}, {n}");
            }
        }
        assert!(groups(true).iter().any(|it| it.fault == Fault::Hang));
    }
}
