from vibeam.extensions.dictionary.mode_share import mode_share as mode_share
from vibeam.extensions.dictionary.terms import contact_terms as contact_terms
from vibeam.extensions.dictionary.terms import restitution_in as restitution_in
from vibeam.extensions.explore.exploration import explore as explore
from vibeam.extensions.identification.decay import identify_decay as identify_decay
from vibeam.extensions.identification.response import identify_frequency_response as identify_frequency_response
from vibeam.extensions.identification.response import identify_response as identify_response
from vibeam.extensions.identification.response import identify_spectrum as identify_spectrum
