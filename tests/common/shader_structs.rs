//! The layout of structs in shaders.

/// Names and offsets of the members of a shader struct.
pub(crate) fn members(module: &naga::Module, name: &str) -> Vec<(String, usize)> {
    let is = |ty: &&naga::Type| ty.name.as_deref() == Some(name);
    let (_, ty) = module.types.iter().find(|(_, ty)| is(ty)).expect("the struct is there");
    let naga::TypeInner::Struct { members, .. } = &ty.inner else { panic!("{name}") };
    let named = |m: &naga::StructMember| (m.name.clone().unwrap(), m.offset as usize);
    members.iter().map(named).collect()
}
