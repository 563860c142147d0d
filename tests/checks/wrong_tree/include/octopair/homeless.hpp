// A public header without a layer.
#pragma once
