// Reads a sample table in WGSL: docs/choosing.md says which table, and how it gets onto the GPU.
// Paste what stands above "EXAMPLE", and give the shape of your table and the bits of its texture.

const FSOT_WIDTH = 64u;
const FSOT_HEIGHT = 64u;
const FSOT_FRAMES = 32u;
const FSOT_SPP = 1u;
const FSOT_DIMS = 2u;
// 2^bits of a UNORM texture: 256 or 65536.
const FSOT_LEVELS = 65536.0;

// Where the k-th use of the table in a frame reads it: add this to the pixel. Use 0 stays in place.
fn fsot_displacement(k: u32) -> vec2<u32> {
    // Steps of the R2 sequence, .7548776662466927 and .5698402909980532, times 2^32; the product wraps.
    let r2 = k * vec2<u32>(3242174889u, 2447445413u);
    return ((r2 >> vec2(16u)) * vec2(FSOT_WIDTH, FSOT_HEIGHT)) >> vec2(16u);
}

// Texel of an atlas, whose frames are stacked downwards; its channels are the dimensions.
fn fsot_atlas(pixel: vec2<u32>, frame: u32) -> vec2<u32> {
    return vec2(pixel.x % FSOT_WIDTH, (frame % FSOT_FRAMES) * FSOT_HEIGHT + pixel.y % FSOT_HEIGHT);
}

// Texel and layer of a 2-D array; its channels are the dimensions.
fn fsot_layer(pixel: vec2<u32>, frame: u32) -> vec3<u32> {
    return vec3(pixel.x % FSOT_WIDTH, pixel.y % FSOT_HEIGHT, frame % FSOT_FRAMES);
}

// Index into a buffer that holds the values of table.npy.
fn fsot_index(pixel: vec2<u32>, frame: u32, s: u32, d: u32) -> u32 {
    let row = (frame % FSOT_FRAMES) * FSOT_HEIGHT + pixel.y % FSOT_HEIGHT;
    return ((row * FSOT_WIDTH + pixel.x % FSOT_WIDTH) * FSOT_SPP + s % FSOT_SPP) * FSOT_DIMS + d;
}

// The number that a UNORM texel stands for, in (0, 1): level k of L came as k / (L - 1), and is (k + 1/2) / L.
// Float textures need none of this.
fn fsot_decode(texel: vec4<f32>) -> vec4<f32> {
    return (round(texel * (FSOT_LEVELS - 1.0)) + 0.5) / FSOT_LEVELS;
}

// EXAMPLE: reads an atlas, a 2-D array and a buffer, all of the same table, for use z / FRAMES of frame z.

@group(0) @binding(0) var atlas: texture_2d<f32>;
@group(0) @binding(1) var layers: texture_2d_array<f32>;
@group(0) @binding(3) var<storage, read> table: array<f32>;
@group(0) @binding(4) var<storage, read_write> numbers: array<vec4<f32>>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let frame = id.z;
    let pixel = id.xy + fsot_displacement(frame / FSOT_FRAMES);

    let a = fsot_decode(textureLoad(atlas, fsot_atlas(pixel, frame), 0)).xy;
    let layer = fsot_layer(pixel, frame);
    let b = fsot_decode(textureLoad(layers, layer.xy, layer.z, 0)).xy;
    let c = vec2(table[fsot_index(pixel, frame, 0u, 0u)], table[fsot_index(pixel, frame, 0u, 1u)]);

    let at = (id.z * 8u * groups.y + id.y) * 8u * groups.x + id.x;
    numbers[2u * at] = vec4(a, b);
    numbers[2u * at + 1u] = vec4(c, 0.0, 0.0);
}
