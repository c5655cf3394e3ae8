#version 450
// Reads a sample table in GLSL: docs/choosing.md says which table, and how it gets onto the GPU.
// Paste what stands above "EXAMPLE", and give the shape of your table and the bits of its texture.

const uint FSOT_WIDTH = 64u;
const uint FSOT_HEIGHT = 64u;
const uint FSOT_FRAMES = 32u;
const uint FSOT_SPP = 1u;
const uint FSOT_DIMS = 2u;
// 2^bits of a UNORM texture: 256 or 65536.
const float FSOT_LEVELS = 65536.0;

// Where the k-th use of the table in a frame reads it: add this to the pixel. Use 0 stays in place.
uvec2 fsot_displacement(uint k) {
    // Steps of the R2 sequence, .7548776662466927 and .5698402909980532, times 2^32; the product wraps.
    uvec2 r2 = k * uvec2(3242174889u, 2447445413u);
    return ((r2 >> 16u) * uvec2(FSOT_WIDTH, FSOT_HEIGHT)) >> 16u;
}

// Texel of an atlas, whose frames are stacked downwards; its channels are the dimensions.
ivec2 fsot_atlas(uvec2 pixel, uint frame) {
    return ivec2(pixel.x % FSOT_WIDTH, (frame % FSOT_FRAMES) * FSOT_HEIGHT + pixel.y % FSOT_HEIGHT);
}

// Texel and layer of a 2-D array; its channels are the dimensions.
ivec3 fsot_layer(uvec2 pixel, uint frame) {
    return ivec3(pixel.x % FSOT_WIDTH, pixel.y % FSOT_HEIGHT, frame % FSOT_FRAMES);
}

// Index into a buffer that holds the values of table.npy.
uint fsot_index(uvec2 pixel, uint frame, uint s, uint d) {
    uint row = (frame % FSOT_FRAMES) * FSOT_HEIGHT + pixel.y % FSOT_HEIGHT;
    return ((row * FSOT_WIDTH + pixel.x % FSOT_WIDTH) * FSOT_SPP + s % FSOT_SPP) * FSOT_DIMS + d;
}

// The number that a UNORM texel stands for, in (0, 1): level k of L came as k / (L - 1), and is (k + 1/2) / L.
// Float textures need none of this.
vec4 fsot_decode(vec4 texel) {
    return (round(texel * (FSOT_LEVELS - 1.0)) + 0.5) / FSOT_LEVELS;
}

// EXAMPLE: reads an atlas, a 2-D array and a buffer, all of the same table, for use z / FRAMES of frame z.
// (OpenGL has `uniform sampler2D atlas`, and reads it by `texelFetch(atlas, …, 0)`.)

layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 0) uniform texture2D atlas;
layout(set = 0, binding = 1) uniform texture2DArray layers;
layout(set = 0, binding = 2) uniform sampler nearest;
layout(std430, set = 0, binding = 3) readonly buffer Table { float table[]; };
layout(std430, set = 0, binding = 4) buffer Numbers { vec4 numbers[]; };

void main() {
    uvec3 id = gl_GlobalInvocationID;
    uint frame = id.z;
    uvec2 pixel = id.xy + fsot_displacement(frame / FSOT_FRAMES);

    vec2 a = fsot_decode(texelFetch(sampler2D(atlas, nearest), fsot_atlas(pixel, frame), 0)).xy;
    vec2 b = fsot_decode(texelFetch(sampler2DArray(layers, nearest), fsot_layer(pixel, frame), 0)).xy;
    vec2 c = vec2(table[fsot_index(pixel, frame, 0u, 0u)], table[fsot_index(pixel, frame, 0u, 1u)]);

    uint at = (id.z * 8u * gl_NumWorkGroups.y + id.y) * 8u * gl_NumWorkGroups.x + id.x;
    numbers[2u * at] = vec4(a, b);
    numbers[2u * at + 1u] = vec4(c, 0.0, 0.0);
}
