#include <tbb/parallel_for.h>
#include "engine/request.hpp"
inline void speak() { std::cout << "a library that prints"; }
