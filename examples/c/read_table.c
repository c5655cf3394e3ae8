/* Reads a table from C: skips the header of the .npy file, then indexes.
 *
 *     cc -std=c99 -O2 -o read_table examples/c/read_table.c -lm
 *     ./read_table data/tables/64x64x1_1spp_2d.npy
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* frames, height, width, samples per pixel, dimensions; values in C order */
typedef struct {
    long t, h, w, spp, d;
    float *values;
} Table;

static int load(FILE *file, Table *table) {
    unsigned char start[10];
    char header[4096] = {0};
    const char *shape;
    size_t length, count;
    if (fread(start, 1, 10, file) != 10 || memcmp(start, "\x93NUMPY\x01", 7) != 0) return 0;
    length = start[8] | (size_t)start[9] << 8;
    if (length >= sizeof header || fread(header, 1, length, file) != length) return 0;
    shape = strstr(header, "'shape': (");
    if (!strstr(header, "'<f4'") || !strstr(header, "False") || !shape) return 0;
    if (sscanf(shape, "'shape': (%ld, %ld, %ld, %ld, %ld", &table->t, &table->h, &table->w, &table->spp, &table->d) != 5)
        return 0;
    count = (size_t)(table->t * table->h * table->w * table->spp * table->d);
    table->values = malloc(count * sizeof(float));
    /* A big-endian machine would swap bytes here. */
    return table->values && fread(table->values, sizeof(float), count, file) == count;
}

/* Coordinate d of sample s in pixel (x, y) of frame t; every index wraps, as a tiled texture does. */
static float sample(const Table *table, long t, long y, long x, long s, long d) {
    long site = ((t % table->t) * table->h + y % table->h) * table->w + x % table->w;
    return table->values[(site * table->spp + s % table->spp) * table->d + d];
}

/* Where the k-th use of a table in a frame reads it, so that no two uses are correlated: *y rows down, *x
 * columns across. */
static void displacement(const Table *table, long k, long *y, long *x) {
    *x = (long)(table->w * fmod(0.7548776662466927 * (double)k, 1.0));
    *y = (long)(table->h * fmod(0.5698402909980532 * (double)k, 1.0));
}

int main(int count, char **arguments) {
    Table table = {0, 0, 0, 0, 0, NULL};
    long y, x;
    FILE *file = count == 2 ? fopen(arguments[1], "rb") : NULL;
    int loaded = file && load(file, &table);
    if (file) fclose(file);
    if (!loaded) {
        fprintf(stderr, "error: no table: give a .npy file of little-endian f32 with five axes, in C order\n");
        return 1;
    }
    printf("%ld %ld %ld %ld %ld\n", table.t, table.h, table.w, table.spp, table.d);
    printf("%.9g\n", sample(&table, 0, 5, 12, 0, 1));
    /* A second pair of numbers for the same pixel. */
    displacement(&table, 1, &y, &x);
    printf("%ld %ld %.9g\n", y, x, sample(&table, 0, 5 + y, 12 + x, 0, 1));
    /* Further frames, rows and columns are those of the tile again. */
    count = sample(&table, table.t, 5 + table.h, 12 + 2 * table.w, 0, 1) != sample(&table, 0, 5, 12, 0, 1);
    free(table.values);
    return count;
}
