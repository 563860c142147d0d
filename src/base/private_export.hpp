// OCTOPAIR_PRIVATE_EXPORT: marks internal classes and functions of the core that other libraries of octopair call.
//
// The shared library of the core exports these symbols under a private version, which is that of the release
// (src/octopair.map). So the other libraries run only with the core of their own release. All other internal symbols are hidden.
#pragma once

#if defined(__GNUC__)
#define OCTOPAIR_PRIVATE_EXPORT [[gnu::visibility("default")]]
#else
#define OCTOPAIR_PRIVATE_EXPORT
#endif
