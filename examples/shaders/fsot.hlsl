// Reads a sample table in HLSL: docs/choosing.md says which table, and how it gets onto the GPU.
// Paste what stands above "EXAMPLE", and give the shape of your table and the bits of its texture.

static const uint FSOT_WIDTH = 64u;
static const uint FSOT_HEIGHT = 64u;
static const uint FSOT_FRAMES = 32u;
static const uint FSOT_SPP = 1u;
static const uint FSOT_DIMS = 2u;
// 2^bits of a UNORM texture: 256 or 65536.
static const float FSOT_LEVELS = 65536.0;

// Where the k-th use of the table in a frame reads it: add this to the pixel. Use 0 stays in place.
uint2 fsot_displacement(uint k) {
    // Steps of the R2 sequence, .7548776662466927 and .5698402909980532, times 2^32; the product wraps.
    uint2 r2 = k * uint2(3242174889u, 2447445413u);
    return ((r2 >> 16u) * uint2(FSOT_WIDTH, FSOT_HEIGHT)) >> 16u;
}

// Texel of an atlas, whose frames are stacked downwards, and its mip level; its channels are the dimensions.
int3 fsot_atlas(uint2 pixel, uint frame) {
    return int3(pixel.x % FSOT_WIDTH, (frame % FSOT_FRAMES) * FSOT_HEIGHT + pixel.y % FSOT_HEIGHT, 0);
}

// Texel, layer and mip level of a 2-D array; its channels are the dimensions.
int4 fsot_layer(uint2 pixel, uint frame) {
    return int4(pixel.x % FSOT_WIDTH, pixel.y % FSOT_HEIGHT, frame % FSOT_FRAMES, 0);
}

// Index into a buffer that holds the values of table.npy.
uint fsot_index(uint2 pixel, uint frame, uint s, uint d) {
    uint row = (frame % FSOT_FRAMES) * FSOT_HEIGHT + pixel.y % FSOT_HEIGHT;
    return ((row * FSOT_WIDTH + pixel.x % FSOT_WIDTH) * FSOT_SPP + s % FSOT_SPP) * FSOT_DIMS + d;
}

// The number that a UNORM texel stands for, in (0, 1): level k of L came as k / (L - 1), and is (k + 1/2) / L.
// Float textures need none of this.
float4 fsot_decode(float4 texel) {
    return (round(texel * (FSOT_LEVELS - 1.0)) + 0.5) / FSOT_LEVELS;
}

// EXAMPLE: reads an atlas, a 2-D array and a buffer, all of the same table, for use z / FRAMES of frame z.

Texture2D<float4> atlas : register(t0);
Texture2DArray<float4> layers : register(t1);
StructuredBuffer<float> table : register(t3);
RWStructuredBuffer<float4> numbers : register(u4);
cbuffer Dispatched : register(b5) { uint3 groups; };

[numthreads(8, 8, 1)]
void main(uint3 id : SV_DispatchThreadID) {
    uint frame = id.z;
    uint2 pixel = id.xy + fsot_displacement(frame / FSOT_FRAMES);

    float2 a = fsot_decode(atlas.Load(fsot_atlas(pixel, frame))).xy;
    float2 b = fsot_decode(layers.Load(fsot_layer(pixel, frame))).xy;
    float2 c = float2(table[fsot_index(pixel, frame, 0u, 0u)], table[fsot_index(pixel, frame, 0u, 1u)]);

    uint at = (id.z * 8u * groups.y + id.y) * 8u * groups.x + id.x;
    numbers[2u * at] = float4(a, b);
    numbers[2u * at + 1u] = float4(c, 0.0, 0.0);
}
