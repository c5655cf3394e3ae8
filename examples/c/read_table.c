/* Reads a table from C: skips the header of the .npy file, then indexes.
 *
 *     cc -std=c99 -O2 -o read_table examples/c/read_table.c
 *     ./read_table data/tables/64x64x1_1spp_2d.npy
 */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* frames, height, width, samples per pixel, dimensions */
typedef struct {
    long t, h, w, spp, d;
    float *values;
} Table;

static int fail(const char *words) {
    fprintf(stderr, "error: %s\n", words);
    return 0;
}

static int load(const char *path, Table *table) {
    unsigned char start[10];
    char header[65536] = {0}; /* versions 2 and 3 of the format allow more; tables need 118 bytes */
    const char *shape;
    size_t length, count;
    FILE *file = fopen(path, "rb");
    if (!file) return fail("the file cannot be opened");
    if (fread(start, 1, 10, file) != 10 || memcmp(start, "\x93NUMPY\x01", 7) != 0)
        return fail("this is no .npy file of version 1");
    length = start[8] | (size_t)start[9] << 8;
    if (length >= sizeof header || fread(header, 1, length, file) != length)
        return fail("the header is cut off");
    shape = strstr(header, "'shape': (");
    if (!strstr(header, "'<f4'") || !strstr(header, "False") || !shape
        || sscanf(shape, "'shape': (%ld, %ld, %ld, %ld, %ld", &table->t, &table->h, &table->w, &table->spp,
                  &table->d) != 5)
        return fail("this is no table: give little-endian f32 in C order, of five axes");
    count = (size_t)(table->t * table->h * table->w * table->spp * table->d);
    table->values = malloc(count * sizeof(float));
    /* A big-endian machine would swap bytes here. */
    if (!table->values || fread(table->values, sizeof(float), count, file) != count)
        return fail("the values are cut off");
    fclose(file);
    return 1;
}

/* Coordinate d of sample s in pixel (x, y) of frame t; every index wraps, as a tiled texture does. */
static float sample(const Table *table, long t, long y, long x, long s, long d) {
    long site = ((t % table->t) * table->h + y % table->h) * table->w + x % table->w;
    return table->values[(site * table->spp + s % table->spp) * table->d + d];
}

int main(int count, char **arguments) {
    Table table;
    double mean = 0.0;
    long x, y;
    if (count != 2 || !load(arguments[1], &table)) return 1;
    printf("%ld x %ld x %ld, %ld samples of %ld dimensions\n", table.t, table.h, table.w, table.spp, table.d);
    for (y = 0; y < table.h; y++)
        for (x = 0; x < table.w; x++) mean += sample(&table, 0, y, x, 0, 0);
    mean /= (double)(table.h * table.w);
    printf("pixel (12, 5): %.7f; mean of the first frame %.4f\n", sample(&table, 0, 5, 12, 0, 0), mean);
    if (sample(&table, 3 * table.t, 5 + table.h, 12 + 2 * table.w, 0, 0) != sample(&table, 0, 5, 12, 0, 0)) return 1;
    free(table.values);
    return mean > 0.49 && mean < 0.51 ? 0 : 1;
}
