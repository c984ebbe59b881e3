/* Functions of one library by a pipe. In: sizes, the function's name, slots, which of them are places in the memory
   that follows. Out: the status, slots and memory as the function leaves them. */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#ifdef OPEN /* by mach_o_image.h */
#elif defined _WIN32
#include <fcntl.h>
#include <io.h>
#include <windows.h>
#define OPEN(path) (void *)LoadLibraryA(path)
#define FIND(library, name) (void *)GetProcAddress((HMODULE)(library), name)
#else
#include <dlfcn.h>
#define OPEN(path) dlopen(path, RTLD_NOW)
#define FIND(library, name) dlsym(library, name)
#endif

static void take(void *to, int64_t size)
{
    if (fread(to, 1, size, stdin) != (size_t)size) exit(0);
}

int main(int count, char **words)
{
#ifdef _WIN32
    _setmode(0, _O_BINARY);
    _setmode(1, _O_BINARY);
#endif
    void *library = OPEN(words[1]);
    if (!library) { fprintf(stderr, "%s cannot be loaded\n", words[1]); return 2; }
    for (;;) {
        int64_t sizes[4]; /* of the name, slots, places, memory */
        take(sizes, 32);
        char *name = calloc(1, sizes[0] + 1), *memory = malloc(sizes[3] + 64);
        int64_t *slots = malloc(8 * sizes[1] + 8), (*places)[2] = malloc(16 * sizes[2] + 16);
        take(name, sizes[0]);
        take(slots, 8 * sizes[1]);
        take(places, 16 * sizes[2]);
        char *begin = memory + (64 - (uintptr_t)memory % 64) % 64;
        take(begin, sizes[3]);
        for (int64_t i = 0; i < sizes[2]; i++) slots[places[i][0]] = (int64_t)(begin + places[i][1]);
        int32_t (*function)(int64_t *) = (int32_t (*)(int64_t *))FIND(library, name);
        if (!function) { fprintf(stderr, "%s is not exported\n", name); return 3; }
        int64_t status = function(slots);
        fwrite(&status, 8, 1, stdout);
        fwrite(slots, 8, sizes[1], stdout);
        fwrite(begin, 1, sizes[3], stdout);
        fflush(stdout);
        free(name), free(memory), free(slots), free(places);
    }
}
