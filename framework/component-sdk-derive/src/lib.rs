//! Derive macros of `component-sdk`. The code they make names `component_sdk` by its crate name.
#![forbid(unsafe_code)] // what the macros expand to is argued in `component-sdk`, module `data`

use proc_macro::TokenStream;
use proc_macro2::TokenStream as Tokens;
use quote::quote;
use syn::{Data, DeriveInput, Error, Field, Fields, LitStr, Result, parse_macro_input};

/// Makes a `#[repr(C)]` structure of numbers, arrays and other port data fit for ports.
/// `#[unit("m")]` on a field names its physical unit.
#[proc_macro_derive(PortData, attributes(unit))]
pub fn derive_port_data(input: TokenStream) -> TokenStream {
    let input = parse_macro_input!(input as DeriveInput);
    port_data(&input)
        .unwrap_or_else(Error::into_compile_error)
        .into()
}

/// Makes a structure of ports. The port's name is the field's, or `#[port("name")]`.
#[proc_macro_derive(Ports, attributes(port))]
pub fn derive_ports(input: TokenStream) -> TokenStream {
    let input = parse_macro_input!(input as DeriveInput);
    ports(&input)
        .unwrap_or_else(Error::into_compile_error)
        .into()
}

fn port_data(input: &DeriveInput) -> Result<Tokens> {
    require_repr_c(input)?;
    let fields = named_fields(input, "port data")?;
    let name = &input.ident;
    let text = name.to_string();
    let mut descriptors = Vec::new();
    let mut hashes = Vec::new();
    for field in fields {
        let (ident, kind) = (&field.ident, &field.ty);
        let field_name = ident.as_ref().map(ToString::to_string).unwrap_or_default();
        let unit = attribute_text(field, "unit")?.unwrap_or_default();
        hashes.push(quote! {
            let hash = ::component_sdk::expansion::field_hash::<#kind>(
                hash, #field_name, ::core::mem::offset_of!(#name, #ident));
        });
        descriptors.push(quote! {
            ::component_sdk::expansion::FieldDescriptor {
                name: ::component_sdk::expansion::Text::new(#field_name),
                unit: ::component_sdk::expansion::Text::new(#unit),
                offset: ::core::mem::offset_of!(#name, #ident),
                kind: <#kind as ::component_sdk::FieldType>::KIND as u32,
                reserved: 0,
                count: <#kind as ::component_sdk::FieldType>::COUNT,
                nested: match <#kind as ::component_sdk::FieldType>::NESTED {
                    Some(nested) => nested,
                    None => ::core::ptr::null(),
                },
            }
        });
    }
    let count = descriptors.len();
    Ok(quote! {
        // SAFETY: every field is a `FieldType` (the constants below demand it), so every bit
        // pattern is valid; the layout is fixed by `repr(C)` and taken from the compiler.
        unsafe impl ::component_sdk::PortData for #name {
            const DESCRIPTOR: &'static ::component_sdk::expansion::TypeDescriptor = &{
                const FIELDS: &[::component_sdk::expansion::FieldDescriptor; #count] =
                    &[#(#descriptors),*];
                let hash = ::component_sdk::expansion::type_hash(
                    #text, ::core::mem::size_of::<#name>());
                #(#hashes)*
                ::component_sdk::expansion::TypeDescriptor {
                    name: ::component_sdk::expansion::Text::new(#text),
                    size: ::core::mem::size_of::<#name>(),
                    alignment: ::core::mem::align_of::<#name>(),
                    layout_hash: hash,
                    fields: FIELDS.as_ptr(),
                    field_count: #count,
                }
            };
        }
        // SAFETY: as above.
        unsafe impl ::component_sdk::FieldType for #name {
            const KIND: ::component_sdk::expansion::ScalarKind =
                ::component_sdk::expansion::ScalarKind::Structure;
            const COUNT: usize = 1;
            const NESTED: Option<&'static ::component_sdk::expansion::TypeDescriptor> =
                Some(<#name as ::component_sdk::PortData>::DESCRIPTOR);
        }
    })
}

fn ports(input: &DeriveInput) -> Result<Tokens> {
    let fields = named_fields(input, "a port set")?;
    let name = &input.ident;
    let mut descriptors = Vec::new();
    let mut binds = Vec::new();
    for (index, field) in fields.iter().enumerate() {
        let (ident, kind) = (&field.ident, &field.ty);
        let index = u32::try_from(index)
            .map_err(|_overflow| Error::new_spanned(field, "too many ports"))?;
        let port_name = attribute_text(field, "port")?
            .or_else(|| ident.as_ref().map(ToString::to_string))
            .unwrap_or_default();
        descriptors.push(quote! {
            ::component_sdk::expansion::PortDescriptor {
                name: ::component_sdk::expansion::Text::new(#port_name),
                kind: <#kind as ::component_sdk::Port>::KIND,
                direction: <#kind as ::component_sdk::Port>::DIRECTION,
                data_type: match <#kind as ::component_sdk::Port>::DATA_TYPE {
                    Some(data_type) => data_type,
                    None => ::core::ptr::null(),
                },
                methods: <#kind as ::component_sdk::Port>::METHODS.as_ptr(),
                method_count: <#kind as ::component_sdk::Port>::METHODS.len(),
            }
        });
        binds.push(quote! { #ident: <#kind as ::component_sdk::Port>::bind(host, #index) });
    }
    Ok(quote! {
        impl ::component_sdk::PortSet for #name {
            const PORTS: &'static [::component_sdk::expansion::PortDescriptor] =
                &[#(#descriptors),*];
            fn bind(host: ::component_sdk::expansion::Host) -> Self {
                Self { #(#binds),* }
            }
        }
    })
}

fn named_fields<'input>(input: &'input DeriveInput, what: &str) -> Result<Vec<&'input Field>> {
    if !input.generics.params.is_empty() {
        let message = format!("{what} cannot be generic: its layout must be known to everyone");
        return Err(Error::new_spanned(&input.generics, message));
    }
    match &input.data {
        Data::Struct(structure) => match &structure.fields {
            Fields::Named(fields) => Ok(fields.named.iter().collect()),
            other => Err(Error::new_spanned(
                other,
                format!("{what} needs named fields"),
            )),
        },
        _ => Err(Error::new_spanned(
            &input.ident,
            format!("{what} must be a struct"),
        )),
    }
}

fn require_repr_c(input: &DeriveInput) -> Result<()> {
    let mut found = false;
    for attribute in &input.attrs {
        if attribute.path().is_ident("repr") {
            attribute.parse_nested_meta(|meta| {
                if meta.path.is_ident("C") {
                    found = true;
                    return Ok(());
                }
                Err(meta.error("port data must be plain #[repr(C)]"))
            })?;
        }
    }
    if found {
        return Ok(());
    }
    Err(Error::new_spanned(
        &input.ident,
        "port data crosses library boundaries: add #[repr(C)]",
    ))
}

fn attribute_text(field: &Field, name: &str) -> Result<Option<String>> {
    field
        .attrs
        .iter()
        .find(|attribute| attribute.path().is_ident(name))
        .map(|attribute| attribute.parse_args::<LitStr>().map(|text| text.value()))
        .transpose()
}
