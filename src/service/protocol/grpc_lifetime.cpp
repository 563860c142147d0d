#include "service/protocol/grpc_lifetime.hpp"

#include <grpc/grpc.h>

namespace octopair::service {

void keep_grpc() {
    static const bool kept = (grpc_init(), true);
    (void)kept;
}

}  // namespace octopair::service
