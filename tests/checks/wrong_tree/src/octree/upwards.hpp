#include "engine/request.hpp"
#include <tbb/parallel_for.h>
inline void speak() { std::cout << "a library that prints"; }
