//! `steadfast run`: brings an application up, watches it, stops it in order.
