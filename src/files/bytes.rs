//! Numbers as they lie in files.

/// Hands out the bytes of values, little-endian, block by block.
pub(crate) fn little_endian<E>(
    values: &[f32],
    mut take: impl FnMut(&[u8]) -> Result<(), E>,
) -> Result<(), E> {
    let mut block = [0; 1 << 12];
    for values in values.chunks(block.len() / size_of::<f32>()) {
        let bytes = &mut block[..size_of_val(values)];
        let (numbers, _) = bytes.as_chunks_mut();
        numbers.iter_mut().zip(values).for_each(|(bytes, value)| *bytes = value.to_le_bytes());
        take(bytes)?;
    }
    Ok(())
}

/// Bytes as two digits each.
pub(crate) fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}
