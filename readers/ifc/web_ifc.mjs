// The module web-ifc. require() loads it in half the time of an import, which looks for the names in its 6 MB first.
import {createRequire} from 'node:module';

export const ifc = createRequire(import.meta.url)('web-ifc');
