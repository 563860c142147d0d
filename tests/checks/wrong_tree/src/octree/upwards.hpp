#include <tbb/parallel_for.h>
#include "engine/request.hpp"
inline const char* used_by_speak() { return "a library that prints"; }
inline void speak() { std::cout << used_by_speak(); }
