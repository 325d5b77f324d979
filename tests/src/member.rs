//! A component of a test's application, with a profile of its own.

/// A component instance with a profile of its own.
#[derive(Debug, Clone)]
pub struct Member {
    instance: String,
    library: String,
    kind: String,
    period_ms: u64,
    priority: u8,
    own_properties: String,
    properties: String,
    ports: String,
    queue: String,
}

impl Member {
    /// An instance of a component of the tests, with its ports; runs every 10 ms.
    pub fn new(instance: &str, library: &str) -> Self {
        Self {
            instance: instance.to_owned(),
            library: library.to_owned(),
            kind: "periodic".to_owned(),
            period_ms: 10,
            priority: 0,
            own_properties: String::new(),
            properties: String::new(),
            ports: ports(library),
            queue: "<queueing_policy>FIFO</queueing_policy><queue_size>1000</queue_size>"
                .to_owned(),
        }
    }

    /// `execution_semantics/type`.
    #[must_use]
    pub fn kind(mut self, kind: &str) -> Self {
        kind.clone_into(&mut self.kind);
        self
    }

    /// Period in milliseconds.
    #[must_use]
    pub fn period(mut self, milliseconds: u64) -> Self {
        self.period_ms = milliseconds;
        self
    }

    /// Priority.
    #[must_use]
    pub fn priority(mut self, priority: u8) -> Self {
        self.priority = priority;
        self
    }

    /// A property in the component's profile.
    #[must_use]
    pub fn property(mut self, name: &str, value: &str) -> Self {
        self.properties += &format!("<property name='{name}'>{value}</property>");
        self
    }

    /// A property that the application gives this instance.
    #[must_use]
    pub fn own_property(mut self, name: &str, value: &str) -> Self {
        self.own_properties += &format!("<property name='{name}'>{value}</property>");
        self
    }

    /// Other ports than the library has.
    #[must_use]
    pub fn ports(mut self, ports: &str) -> Self {
        ports.clone_into(&mut self.ports);
        self
    }

    /// What data inputs keep; without it, more than arrives in any test.
    #[must_use]
    pub fn queue(mut self, policy: &str, size: usize) -> Self {
        self.queue =
            format!("<queueing_policy>{policy}</queueing_policy><queue_size>{size}</queue_size>");
        self
    }

    /// Instance name.
    pub(crate) fn instance(&self) -> &str {
        &self.instance
    }

    /// Its profile.
    pub(crate) fn profile(&self) -> String {
        let input = "<usage>input</usage>";
        format!(
            "<component_profile><name>{}</name>\n\
             <execution_environment><library_name>{}</library_name></execution_environment>\n\
             <execution_semantics><type>{}</type><period>{}</period><priority>{}</priority>\
             </execution_semantics>\n<properties>{}</properties>\n<ports>{}</ports>\n\
             </component_profile>",
            self.instance,
            self.library,
            self.kind,
            self.period_ms,
            self.priority,
            self.properties,
            self.ports.replace(input, &format!("{input}{}", self.queue)),
        )
    }

    /// Its place in the application.
    pub(crate) fn subcomponent(&self) -> String {
        format!(
            "<subcomponent><name>{0}</name><reference>{0}.xml</reference>\
             <properties>{1}</properties></subcomponent>",
            self.instance, self.own_properties
        )
    }
}

/// Ports of the libraries of the tests, as profiles declare them.
fn ports(library: &str) -> String {
    let data = |name: &str, usage: &str| {
        format!(
            "<data_port><name>{name}</name><usage>{usage}</usage>\
             <data_type>Sample</data_type></data_port>"
        )
    };
    let event = |name: &str, usage: &str| {
        format!(
            "<event_port><name>{name}</name><usage>{usage}</usage>\
             <data_type>Sample</data_type></event_port>"
        )
    };
    let service = |usage: &str| {
        format!(
            "<service_port><name>arithmetic</name><usage>{usage}</usage>\
             <type>Arithmetic</type></service_port>"
        )
    };
    match library {
        "counter" => data("output", "output"),
        "recorder" => data("input", "input"),
        "echo" => data("input", "input") + &data("output", "output"),
        "refiner" => {
            data("input", "input") + &data("output", "output") + &data("expected", "output")
        }
        "low_pass" => data("raw", "input") + &data("smooth", "output"),
        "herald" => event("news", "output"),
        "listener" => event("news", "input"),
        "adder" => service("provided"),
        "asker" => service("required"),
        "sentry" => {
            ["fault", "emergency_stop"]
                .map(|name| {
                    format!("<event_port><name>{name}</name><usage>input</usage></event_port>")
                })
                .concat()
                + "<event_port><name>alarm</name><usage>output</usage></event_port>"
        }
        "diary" | "no_component" | "old_abi" | "wrong_layout" | "crashes_when_loaded" => {
            String::new()
        }
        _faulty => data("output", "output") + &event("heard", "input") + &service("provided"),
    }
}
