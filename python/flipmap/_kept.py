"""Arrays that keep notes about themselves, and only while they are whole."""

import copy

import numpy as np

_PLAIN_METHODS = (
    "astype", "byteswap", "choose", "compress", "diagonal", "flatten", "getfield", "ravel",
    "repeat", "reshape", "squeeze", "swapaxes", "take", "transpose", "view",
)


class Kept(np.ndarray):
    """A structured array with notes: attributes that copies and pickles of the whole keep.

    Its fields, its parts and what is computed from it are plain arrays and numbers of NumPy,
    which the notes would not describe.
    """

    _NOTES = ()

    def __array_finalize__(self, of):
        is_whole = isinstance(of, type(self)) and (of.shape, of.dtype) == (self.shape, self.dtype)
        for name in self._NOTES:
            setattr(self, name, getattr(of, name) if is_whole else None)

    def __array_wrap__(self, array, context=None, return_scalar=False):
        plain = np.asarray(array)
        return plain[()] if plain.ndim == 0 else plain

    def __array_function__(self, function, types, args, kwargs):
        made = super().__array_function__(function, types, args, kwargs)
        return made if not isinstance(made, Kept) or made._is_whole() else np.asarray(made)

    def __getitem__(self, key):
        return np.asarray(self)[key]

    def __eq__(self, other):
        return np.asarray(self) == np.asarray(other)

    def __ne__(self, other):
        return np.asarray(self) != np.asarray(other)

    __hash__ = None

    @property
    def T(self):
        return np.asarray(self).T

    def __deepcopy__(self, memo):
        made = self.copy()
        for name in self._NOTES:
            setattr(made, name, copy.deepcopy(getattr(self, name), memo))
        return made

    def __reduce__(self):
        make, arguments, state = super().__reduce__()
        return make, arguments, (state, {name: getattr(self, name) for name in self._NOTES})

    def __setstate__(self, state):
        array, notes = state
        super().__setstate__(array)
        for name in self._NOTES:
            setattr(self, name, notes.get(name))

    def _is_whole(self):
        return all(getattr(self, name) is not None for name in self._NOTES)


def _plain(name):
    def method(self, *args, **kwargs):
        return getattr(np.asarray(self), name)(*args, **kwargs)

    method.__name__ = name
    method.__doc__ = getattr(np.ndarray, name).__doc__
    return method


for _name in _PLAIN_METHODS:
    setattr(Kept, _name, _plain(_name))
