//! What components ask for now and then: properties, log, fault reports, devices.

use component_abi::Status;
use fault_manager::{DetectorId, Evidence, Observation, Symptom};
use system_model::fault::{Fault, FaultKind};

use super::Services;
use crate::device;
use crate::event_log::Event;
use crate::guard::{ForeignBytesMut, ForeignText};

impl Services {
    pub(super) fn property(
        &mut self,
        name: ForeignText,
        value: ForeignBytesMut,
        length: ForeignBytesMut,
    ) -> Result<Status, Status> {
        let name = self.text(name, "property")?;
        // The subcomponent's own values stand last and win.
        let found = self.properties.iter().rev().find(|(key, _)| *key == name);
        let Some((_, text)) = found else {
            return Ok(Status::NOTHING);
        };
        let bytes = text.as_bytes();
        if !length.copy_from(&bytes.len().to_ne_bytes()) {
            return Err(self.bad_pointer("property"));
        }
        if bytes.len() > value.size() {
            return Ok(Status::OUT_OF_RESOURCES);
        }
        if value.copy_from(bytes) {
            Ok(Status::SUCCESS)
        } else {
            Err(self.bad_pointer("property"))
        }
    }

    pub(super) fn log(&mut self, level: u32, message: ForeignText) -> Result<Status, Status> {
        let message = self.text(message, "log")?;
        let level = match level {
            1 => "error",
            2 => "warning",
            3 => "information",
            _ => "debug",
        };
        self.record(Event::Log {
            component: self.name.to_string(),
            level,
            message,
        });
        Ok(Status::SUCCESS)
    }

    pub(super) fn report_fault(
        &mut self,
        code: Status,
        message: ForeignText,
    ) -> Result<Status, Status> {
        let message = self.text(message, "report_fault")?;
        let mut fault = Fault::new(
            FaultKind::Reported,
            self.callback,
            format!("{message} ({code})"),
        );
        fault.return_code = code.0;
        self.record(Event::fault(&self.name, self.incarnation, &fault));
        let named = self.named_faults.iter();
        let named = named.filter(|(name, _)| message.starts_with(name.as_str()));
        let narrowest = named.max_by_key(|(name, _)| name.len());
        let detector = narrowest
            .map(|(_, detector)| *detector)
            .or_else(|| self.detectors.map(|all| all.reported));
        if let Some(detector) = detector {
            self.report_symptom(detector, fault.message, code.0);
        }
        Ok(Status::SUCCESS)
    }

    /// The component named a datum or an event of another size than its type has. It is told, and
    /// so is the fault manager.
    #[cold]
    pub(super) fn wrong_size(&self, port: u32, size: usize, expected: usize) -> Status {
        if let Some(detectors) = self.detectors {
            let evidence = Evidence::Size {
                port: self.port_name(port as usize),
                size,
                expected,
            };
            self.tell(detectors.exception, FaultKind::WrongSize, 0, evidence);
        }
        Status::BAD_INPUT_PARAMETER
    }

    /// A fault that the component itself told of; it goes on.
    pub(super) fn report_symptom(&self, detector: DetectorId, message: String, return_code: u32) {
        let evidence = Evidence::Exception {
            callback: self.callback.to_owned(),
            message,
            place: None,
            signal: None,
            address: None,
            backtrace: Vec::new(),
            thread_lost: false,
            damage: None,
        };
        self.tell(detector, FaultKind::Reported, return_code, evidence);
    }

    fn tell(&self, detector: DetectorId, kind: FaultKind, return_code: u32, evidence: Evidence) {
        let symptom = Symptom {
            detector,
            incarnation: self.incarnation,
            kind,
            return_code,
            at: self.environment.clock.now(),
            runs: true,
            evidence,
        };
        self.environment
            .observations
            .report(Observation::Symptom(Box::new(symptom)));
    }

    pub(super) fn failed(
        &mut self,
        message: ForeignText,
        file: ForeignText,
        line: u32,
        column: u32,
    ) -> Result<Status, Status> {
        let message = self.text(message, "failed")?;
        let file = self.text(file, "failed")?;
        let explanation = self.explanation.get_or_insert_default();
        explanation.message = message;
        explanation.place = (line > 0).then_some((file, line, column));
        Ok(Status::SUCCESS)
    }

    pub(super) fn open_device(
        &mut self,
        name: ForeignText,
        descriptor: ForeignBytesMut,
    ) -> Result<Status, Status> {
        let name = self.text(name, "open_device")?;
        match device::open(&name, self.world.as_deref()) {
            Ok(device) => {
                if let Some(path) = &device.path {
                    let message = format!("device '{name}' is {}", path.display());
                    self.record(Event::Notice { message });
                }
                let number = device.number();
                if descriptor.copy_from(&number.to_ne_bytes()) {
                    device.give_away();
                    Ok(Status::SUCCESS)
                } else {
                    Err(self.bad_pointer("open_device"))
                }
            }
            Err(error) => {
                self.record(Event::Log {
                    component: self.name.to_string(),
                    level: "error",
                    message: error.to_string(),
                });
                self.explanation.get_or_insert_default().device = Some(error.to_string());
                Ok(Status::CALLEE_ERROR)
            }
        }
    }
}
