//! Where what stands in the memory that an instance shares with the container. Computed once by the
//! container; the host is told.

use serde::{Deserialize, Serialize};
use system_model::data_type::DataType;
use system_model::specification::{PortDirection, PortKind};

use crate::library::PortDescription;

/// The header: the turn, the sign of life, and the words of a message.
const HEADER_BYTES: usize = 4096;

/// A cache line: what two processors write is not on the same.
const LINE: usize = 64;

/// Pages of the machines we run on.
pub(super) const PAGE: usize = 4096;

/// Least room for the content of a message: two texts of the longest length that is taken from a
/// component, and a property's value.
const LEAST_CONTENT_BYTES: usize = 64 * 1024;

/// How often every output can be written in one callback before what was written is handed over
/// in the middle of it.
const WRITES: usize = 4;

/// Room for memory that the component registers as critical; takes no memory before it is used.
const CRITICAL_BYTES: usize = 64 << 20;

/// A part of the shared memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Area {
    /// Of its first byte.
    pub(super) offset: usize,
    /// In bytes.
    pub(super) size: usize,
}

/// One port, as far as data are concerned.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum PortArea {
    /// A data input, and where its datum is put.
    Input(Area),
    /// A data output whose data have this size in bytes.
    Output(usize),
    /// No data port.
    Other,
}

/// All parts.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Layout {
    /// By port number.
    pub(super) ports: Vec<PortArea>,
    /// A word for every port: what the component is offered to read there.
    pub(super) offers: Area,
    /// Content of messages to the host.
    pub(super) to_host: Area,
    /// Content of messages to the container.
    pub(super) to_container: Area,
    /// What the component has written in this callback.
    pub(super) written: Area,
    /// Critical memory.
    pub(super) critical: Area,
    /// Of the whole memory, in bytes.
    pub(super) total: usize,
}

impl Area {
    /// A part of it, if it is inside.
    pub(super) fn part(self, offset: usize, size: usize) -> Option<Self> {
        let end = offset.checked_add(size)?;
        (end <= self.size).then_some(Self {
            offset: self.offset + offset,
            size,
        })
    }
}

impl Layout {
    /// The layout for a component with these ports.
    pub(super) fn of(ports: &[PortDescription]) -> Self {
        let mut end = HEADER_BYTES;
        let mut take = |size: usize, unit: usize| {
            let offset = end.next_multiple_of(unit);
            end = offset + size;
            Area { offset, size }
        };
        let mut written = LEAST_CONTENT_BYTES;
        let mut areas = Vec::with_capacity(ports.len());
        for port in ports {
            let size = size_of_type(port.data_type.as_ref());
            areas.push(match (port.kind, port.direction) {
                (PortKind::Data, PortDirection::Input) => PortArea::Input(take(size, LINE)),
                (PortKind::Data, PortDirection::Output) => {
                    written += WRITES * (size + LINE);
                    PortArea::Output(size)
                }
                _ => PortArea::Other,
            });
        }
        let offers = take(8 * ports.len(), LINE);
        let content = ports.iter().flat_map(contents).max().unwrap_or_default();
        let content = content.max(LEAST_CONTENT_BYTES);
        let to_host = take(content, LINE);
        let to_container = take(content, LINE);
        let written = take(written, LINE);
        let critical = take(CRITICAL_BYTES, PAGE);
        Self {
            ports: areas,
            offers,
            to_host,
            to_container,
            written,
            critical,
            total: critical.offset + critical.size,
        }
    }

    /// Bytes from the beginning that every component uses; critical memory lies behind.
    pub(super) fn front(&self) -> usize {
        self.critical.offset
    }

    /// Of a port.
    pub(super) fn port(&self, port: u32) -> PortArea {
        let port = self.ports.get(port as usize);
        port.copied().unwrap_or(PortArea::Other)
    }
}

/// Sizes of all that can be the content of one message of a port; data have places of their own.
fn contents(port: &PortDescription) -> Vec<usize> {
    let methods = port.methods.iter();
    let of_methods = methods.flat_map(|method| [&method.request, &method.reply]);
    let mut sizes: Vec<usize> = of_methods
        .map(|data_type| size_of_type(data_type.as_ref()))
        .collect();
    if port.kind != PortKind::Data {
        sizes.push(size_of_type(port.data_type.as_ref()));
    }
    sizes
}

fn size_of_type(data_type: Option<&DataType>) -> usize {
    data_type.map_or(0, |data_type| data_type.size)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn port(kind: PortKind, direction: PortDirection, size: usize) -> PortDescription {
        PortDescription {
            name: "port".to_owned(),
            kind,
            direction,
            data_type: Some(DataType {
                name: "Datum".to_owned(),
                size,
                layout_hash: 0,
                fields: Vec::new(),
            }),
            methods: Vec::new(),
        }
    }

    #[test]
    fn no_two_parts_overlap_and_each_is_large_enough() {
        let layout = Layout::of(&[
            port(PortKind::Data, PortDirection::Input, 100),
            port(PortKind::Data, PortDirection::Output, 1 << 20),
            port(PortKind::Event, PortDirection::Input, 200_000),
            port(PortKind::Data, PortDirection::Input, 8),
        ]);
        let inputs = layout.ports.iter().filter_map(|port| match port {
            PortArea::Input(area) => Some(*area),
            _ => None,
        });
        let mut areas: Vec<Area> = inputs.collect();
        areas.extend([
            layout.offers,
            layout.to_host,
            layout.to_container,
            layout.written,
            layout.critical,
        ]);
        let mut end = HEADER_BYTES;
        for area in areas {
            assert!(area.offset >= end, "{layout:?}");
            end = area.offset + area.size;
        }
        assert_eq!(end, layout.total);
        assert_eq!(layout.port(1), PortArea::Output(1 << 20));
        assert!(layout.written.size > 4 << 20);
        assert_eq!(layout.to_host.size, 200_000, "the event's content");
        assert_eq!(layout.critical.offset % PAGE, 0);
        assert_eq!(layout.port(9), PortArea::Other);
    }

    #[test]
    fn a_part_is_inside_or_it_is_none() {
        let area = Area {
            offset: 100,
            size: 10,
        };
        for (offset, size, inside) in [
            (0, 10, true),
            (10, 0, true),
            (1, 10, false),
            (usize::MAX, 2, false),
        ] {
            assert_eq!(area.part(offset, size).is_some(), inside, "{offset} {size}");
        }
    }
}
