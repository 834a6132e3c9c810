/*
 * Stands in for a library of Windows 10 that wine 8 does not have and Rust's standard library is linked to: random bytes,
 * which the components never ask for.
 */
#include <stddef.h>

__declspec(dllimport) unsigned char SystemFunction036(void *buffer, unsigned long size);

__declspec(dllexport) int ProcessPrng(void *buffer, size_t size)
{
    return SystemFunction036(buffer, (unsigned long)size);
}
