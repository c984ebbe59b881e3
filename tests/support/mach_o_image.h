/* Mapping of a macOS library's image (mach_o_image.py) under Linux, in the place of dlopen and dlsym: the ways of calling
   a function are the same for numbers and addresses, and the system's functions are the C library's. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/mman.h>

struct range { int64_t begin, size, protection; };
struct binding { int64_t place, addend; char name[48]; };
struct export { int64_t place; char name[48]; };
struct image { char *base; int64_t exports; struct export *exported; };
struct pair { double sine, cosine; }; /* in two registers of floating-point numbers, here as there */

static struct pair sincos_stret(double x) { return (struct pair){sin(x), cos(x)}; }
static void zero(void *to, size_t size) { memset(to, 0, size); }
static void late(void) { fprintf(stderr, "a function was to be bound at its first call\n"); abort(); }

static const struct { const char *name; void *function; } SYSTEM[] = {
    {"_cos", cos}, {"_cosh", cosh}, {"_exp", exp}, {"_expm1", expm1}, {"_fmod", fmod}, {"_hypot", hypot},
    {"_ldexp", ldexp}, {"_pow", pow}, {"_sin", sin}, {"_sinh", sinh}, {"_memcpy", memcpy}, {"_memset", memset},
    {"_bzero", zero}, {"___bzero", zero}, {"___sincos_stret", sincos_stret}, {"dyld_stub_binder", late},
};

static void *items(FILE *file, int64_t count, size_t size)
{
    void *found = malloc(count * size + 1);
    return fread(found, size, count, file) == (size_t)count ? found : NULL;
}

static void *system_function(const char *name)
{
    for (size_t i = 0; i < sizeof SYSTEM / sizeof *SYSTEM; i++)
        if (!strcmp(name, SYSTEM[i].name)) return SYSTEM[i].function;
    fprintf(stderr, "the system has no %s\n", name);
    return NULL;
}

static void *open_image(const char *path)
{
    FILE *file = fopen(path, "rb");
    int64_t n[5]; /* bytes, ranges, slid places, bindings, exports */
    if (!file || fread(n, 8, 5, file) != 5) return NULL;
    char *base = mmap(NULL, n[0], PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (base == MAP_FAILED || fread(base, 1, n[0], file) != (size_t)n[0]) return NULL;
    struct range *ranges = items(file, n[1], sizeof *ranges);
    int64_t *slid = items(file, n[2], sizeof *slid);
    struct binding *bindings = items(file, n[3], sizeof *bindings);
    struct image *found = malloc(sizeof *found);
    *found = (struct image){base, n[4], items(file, n[4], sizeof *found->exported)};
    if (!ranges || !slid || !bindings || !found->exported) return NULL;
    for (int64_t i = 0; i < n[2]; i++) *(int64_t *)(base + slid[i]) += (int64_t)base;
    for (int64_t i = 0; i < n[3]; i++) {
        char *function = system_function(bindings[i].name);
        if (!function) return NULL;
        *(int64_t *)(base + bindings[i].place) = (int64_t)function + bindings[i].addend;
    }
    __builtin___clear_cache(base, base + n[0]);
    for (int64_t i = 0; i < n[1]; i++) /* the bits of read, write, run are those of Linux */
        if (mprotect(base + ranges[i].begin, ranges[i].size, ranges[i].protection)) return NULL;
    fclose(file);
    return found;
}

static void *find_in_image(const struct image *image, const char *name)
{
    for (int64_t i = 0; i < image->exports; i++)
        if (image->exported[i].name[0] == '_' && !strcmp(image->exported[i].name + 1, name))
            return image->base + image->exported[i].place;
    return NULL;
}

#define OPEN(path) open_image(path)
#define FIND(library, name) find_in_image(library, name)
