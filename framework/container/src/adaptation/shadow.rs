//! An instance that is run for an estimate: it has a component's library and properties, ports that
//! lead nowhere else, and nobody knows of it.

use std::sync::Arc;

use system_model::life_cycle::{LifeCycleState, Operation};
use system_model::specification::QueuePolicy;

use super::outlet::Heard;
use crate::assembly::Factory;
use crate::component::{Component, OperationError, PortEnd};
use crate::guard::Callback;
use crate::lane::Lane;
use crate::port::{Receiver, Sender, connection};
use crate::status::ComponentStatus;

/// An instance with the far ends of its ports.
pub struct Shadow {
    /// The component's name.
    pub name: String,
    instance: Component,
    inputs: Vec<(String, Sender)>,
    outputs: Vec<(String, Receiver, Option<Heard>)>,
}

impl Shadow {
    /// Makes one and brings it up; it goes on from `memory`, if the component has registered any.
    ///
    /// # Errors
    /// Why it does not come up; in words.
    pub fn new(factory: &Factory, memory: Option<Vec<u8>>, lane: &Lane) -> Result<Self, String> {
        let name = factory.variants().first();
        let name = name.map_or_else(String::new, |first| first.specification.name.clone());
        let status = Arc::new(ComponentStatus::standby(name.clone()));
        let instance = factory.make(0, status)?;
        let mut shadow = Self {
            instance,
            inputs: Vec::new(),
            outputs: Vec::new(),
            name,
        };
        shadow.connect();
        shadow.bring_up(memory, lane)?;
        Ok(shadow)
    }

    fn connect(&mut self) {
        let services = self.instance.services_mut();
        let names: Vec<String> = services
            .interface()
            .iter()
            .map(|it| it.name.clone())
            .collect();
        for (index, name) in names.into_iter().enumerate() {
            match services.port_mut(index) {
                Some(PortEnd::DataInput(input)) => {
                    let (sender, receiver) = connection(QueuePolicy::Last, 1, input.size);
                    input.source = Some(receiver);
                    self.inputs.push((name, sender));
                }
                Some(PortEnd::DataOutput(output)) => {
                    let (sender, receiver) = connection(QueuePolicy::Last, 1, output.size);
                    output.connections.push((sender, None));
                    self.outputs.push((name, receiver, None));
                }
                _ => {}
            }
        }
    }

    fn bring_up(&mut self, memory: Option<Vec<u8>>, lane: &Lane) -> Result<(), String> {
        let loss = lane.loss();
        let (name, instance) = (&self.name, &mut self.instance);
        let words = |error: OperationError| in_words(name, error);
        instance.construct(loss).map_err(words)?;
        instance
            .operate(Operation::Initialize, loss)
            .map_err(words)?;
        if memory.is_some_and(|memory| instance.set_critical(&memory)) {
            let recovered = instance.call_back(Callback::Recover, "onRecover", loss);
            recovered.map_err(words)?;
        }
        instance.operate(Operation::Start, loss).map_err(words)
    }

    /// Gives it a datum.
    pub fn send(&mut self, port: &str, heard: &Heard) {
        let input = self.inputs.iter_mut().find(|(name, _)| name == port);
        if let Some((_, sender)) = input {
            sender.send(heard.stamp_ns, heard.incarnation, |bytes| {
                let fits = bytes.len() == heard.bytes.len();
                if fits {
                    bytes.copy_from_slice(&heard.bytes);
                }
                fits
            });
        }
    }

    /// Lets it run for a cycle.
    ///
    /// # Errors
    /// What went wrong; in words.
    pub fn run(&mut self, now_ns: u64, lane: &Lane) -> Result<(), String> {
        self.instance.execute(now_ns, lane.loss());
        if self.instance.is_active() {
            self.instance.updated(lane.loss());
        }
        if self.instance.state() != LifeCycleState::Active {
            let fault = self.instance.status().last_fault();
            return Err(format!("'{}': {}", self.name, fault.unwrap_or_default()));
        }
        for (_, receiver, newest) in &mut self.outputs {
            while let Some(datum) = receiver.receive() {
                *newest = Some(Heard {
                    stamp_ns: datum.stamp_ns(),
                    incarnation: datum.incarnation(),
                    bytes: datum.bytes().to_vec(),
                });
            }
        }
        Ok(())
    }

    /// What it has written last.
    pub fn written(&self, port: &str) -> Option<&Heard> {
        let output = self.outputs.iter().find(|(name, ..)| name == port);
        output.and_then(|(_, _, newest)| newest.as_ref())
    }
}

impl Shadow {
    /// Brings it down, so that what it holds is freed; that it fails at that matters to nobody.
    pub fn end(mut self, lane: &Lane) {
        for operation in [Operation::Stop, Operation::Destroy] {
            let _nobody_waits = self.instance.operate(operation, lane.loss());
        }
    }
}

impl Drop for Shadow {
    /// Nothing is called any more of one that did not get to its end.
    fn drop(&mut self) {
        self.instance.retire();
    }
}

fn in_words(name: &str, error: OperationError) -> String {
    match error {
        OperationError::Refused => format!("'{name}' does not come up"),
        OperationError::Failed(fault) => {
            format!(
                "'{name}': {} in {}: {}",
                fault.kind, fault.callback, fault.message
            )
        }
    }
}
