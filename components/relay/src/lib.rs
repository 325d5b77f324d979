//! Relay: passes on what it gets, in order, and keeps account of what was missing and what came
//! twice.
//!
//! Property `source`: makes a datum of its own in each cycle instead (default false). The account
//! is registered as critical memory of 4 KiB. When stopped it logs its account.
#![forbid(unsafe_code)]

mod account;

use component_sdk::prelude::*;

use account::Account;

/// Values repeat after so many data, so that they stay in a range that a rule can name.
const VALUES: u64 = 1000;

/// What is passed on.
#[derive(PortData, Debug, Clone, Copy, Default, PartialEq)]
#[repr(C)]
pub struct Parcel {
    /// Counted from 1 by the source.
    sequence: u64,
    /// When the source made it, by the container's clock.
    #[unit("ns")]
    time: u64,
    /// From 0 to 999.
    value: f64,
}

/// Ports of the relay.
#[derive(Ports)]
pub struct RelayPorts {
    input: Input<Parcel>,
    output: Output<Parcel>,
}

/// The relay.
pub struct Relay {
    ports: RelayPorts,
    is_source: bool,
    account: Option<&'static mut Account>,
}

impl Component for Relay {
    type Ports = RelayPorts;

    fn new(ports: RelayPorts) -> Self {
        Self {
            ports,
            is_source: false,
            account: None,
        }
    }

    fn on_initialize(&mut self, context: &Context) -> Outcome {
        self.is_source = context.property_or("source", false)?;
        match &mut self.account {
            Some(account) => **account = Account::default(),
            None => self.account = Some(context.critical(Account::default())?),
        }
        Ok(())
    }

    fn on_execute(&mut self, context: &Context) -> Outcome {
        let Some(account) = &mut self.account else {
            return Ok(());
        };
        if self.is_source {
            let parcel = parcel(account.last() + 1, context.now());
            account.take_in(parcel.sequence);
            self.ports.output.write(&parcel);
        }
        while let Some(parcel) = self.ports.input.read() {
            account.take_in(parcel.sequence);
            self.ports.output.write(&parcel);
        }
        Ok(())
    }

    fn on_stop(&mut self, context: &Context) -> Outcome {
        if let Some(account) = &self.account {
            context.info(account.to_string());
        }
        Ok(())
    }
}

fn parcel(sequence: u64, now: std::time::Duration) -> Parcel {
    #[allow(clippy::cast_precision_loss)] // below 1000
    let value = (sequence % VALUES) as f64;
    Parcel {
        sequence,
        time: u64::try_from(now.as_nanos()).unwrap_or(u64::MAX),
        value,
    }
}

export_component!(Relay);
