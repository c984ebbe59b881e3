// Start of any page: what of its tables and pictures can be saved; the section that its address names.
import { address } from "./state.js";
import { offerStanding } from "./saving.js";

offerStanding();
address.go();
